// A solver in C++, without any library: g++ -O2 -o gaussian_search gaussian_search.cpp
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <vector>
using Numbers = std::vector<double>;
// The numbers behind a key: a list, or one alone. Costs that are not finite come as texts: "inf", "-inf" and "nan".
Numbers numbers(const std::string& line, const std::string& key) {
    Numbers found;
    size_t place = line.find("\"" + key + "\":");
    if (place == std::string::npos) return found;
    const char* at = line.c_str() + place + key.size() + 3;
    const bool list = *at == '[';
    for (at += list; *at != ']'; at += list && *at == ',') {
        at += *at == '"';
        char* end;
        found.push_back(std::strtod(at, &end));
        if (end == at || !list) break;
        at = end + (*end == '"');
    }
    return found;
}

int main() {
    std::string line;
    if (!std::getline(std::cin, line)) return 1;
    const Numbers lower = numbers(line, "lower"), upper = numbers(line, "upper");
    const size_t n = lower.size(), size = 32;
    std::mt19937 rng(static_cast<unsigned>(numbers(line, "seed").at(0)));
    std::normal_distribution<double> normal;
    Numbers best(n);
    for (size_t i = 0; i < n; i++) best[i] = 0.5 * (lower[i] + upper[i]);
    double least = std::numeric_limits<double>::infinity(), radius = 0.5;
    std::cout << "{\"hello\":{\"name\":\"gaussian-search\",\"version\":\"1\"}}" << std::endl;
    for (;;) {
        std::vector<Numbers> points(size, best);
        std::string question = "{\"id\":1,\"x\":[";
        for (Numbers& x : points) {
            for (size_t i = 0; i < n; i++) {
                x[i] = std::clamp(best[i] + radius * (upper[i] - lower[i]) * normal(rng), lower[i], upper[i]);
                char text[32];
                std::snprintf(text, sizeof text, "%s%.17g", i ? "," : &x == &points[0] ? "[" : ",[", x[i]);
                question += text;
            }
            question += "]";
        }
        std::cout << question << "]}" << std::endl;
        if (!std::getline(std::cin, line) || line.find("\"stop\"") != std::string::npos) return 0;
        const Numbers costs = numbers(line, "cost");
        const double before = least;
        for (size_t k = 0; k < costs.size(); k++)
            if (costs[k] < least) least = costs[k], best = points[k];
        radius = std::min(0.5, radius * (least < before ? 1.2 : 0.7));
    }
}
