# A solver in Julia: julia gaussian_search.jl. It needs the package JSON.
using JSON, Random

say(message) = (println(JSON.json(message)); flush(stdout))
number(value) = value isa Number ? Float64(value) : Dict("inf" => Inf, "-inf" => -Inf, "nan" => NaN)[value]

function search(opening)
    lower, upper = Float64.(opening["problem"]["lower"]), Float64.(opening["problem"]["upper"])
    rng = MersenneTwister(opening["seed"])
    best, least, radius = (lower + upper) / 2, Inf, 0.5
    say(Dict("hello" => Dict("name" => "gaussian-search", "version" => "1")))
    while true
        points = [clamp.(best + radius * (upper - lower) .* randn(rng, length(lower)), lower, upper) for _ in 1:32]
        say(Dict("x" => points))
        line = readline(stdin)
        answer = isempty(line) ? Dict("stop" => "end of input") : JSON.parse(line)
        haskey(answer, "stop") && return
        costs = number.(answer["cost"])
        lowest, k = findmin(replace(costs, NaN => Inf))
        if lowest < least
            best, least, radius = points[k], lowest, min(0.5, 1.2 * radius)
        else
            radius *= 0.7
        end
    end
end

search(JSON.parse(readline(stdin)))
