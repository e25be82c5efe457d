% A solver in Octave: octave-cli --quiet gaussian_search.m
opening = jsondecode(fgetl(stdin));
lower = opening.problem.lower(:)';
upper = opening.problem.upper(:)';
count = 32;
rand("twister", opening.seed);
randn("twister", opening.seed);
best = (lower + upper) / 2;
least = Inf;
radius = 0.5;

function say(text)
  fprintf("%s\n", text);
  fflush(stdout);
end

% Costs that are not finite come as texts.
function line = numbers(line)
  line = strrep(strrep(line, '"inf"', "1e999"), '"nan"', "null");
end

say('{"hello":{"name":"gaussian-search","version":"1"}}');
while true
  points = best + radius * (upper - lower) .* randn(count, numel(lower));
  points = min(max(points, lower), upper);
  rows = arrayfun(@(k) ["[" strjoin(cellfun(@(x) sprintf("%.17g", x), num2cell(points(k, :)), "UniformOutput", false), ",") "]"], ...
                  1:count, "UniformOutput", false);
  say(['{"id":1,"x":[' strjoin(rows, ",") "]}"]);
  line = fgetl(stdin);
  if ! ischar(line) || isfield(answer = jsondecode(numbers(line)), "stop")
    break
  end
  costs = answer.cost;
  [lowest, k] = min(costs);
  if lowest < least
    least = lowest;
    best = points(k, :);
    radius = min(0.5, 1.2 * radius);
  else
    radius *= 0.7;
  end
end
