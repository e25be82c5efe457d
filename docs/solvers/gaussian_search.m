% A solver in Octave: octave-cli --quiet gaussian_search.m
% `input` reads a line as soon as it is there; `fgetl` would wait for the next one.
opening = jsondecode(input("", "s"));
lower = opening.problem.lower(:)';
upper = opening.problem.upper(:)';
count = 32;
randn("twister", opening.seed);
best = (lower + upper) / 2;
least = Inf;
radius = 0.5;
row = ["[" strjoin(repmat({"%.17g"}, 1, numel(lower)), ",") "]"];
printf('{"hello":{"name":"gaussian-search","version":"1"}}\n');
fflush(stdout);
while true
  points = best + radius * (upper - lower) .* randn(count, numel(lower));
  points = min(max(points, lower), upper);
  rows = sprintf([row ","], points');
  printf('{"x":[%s]}\n', rows(1:end-1));
  fflush(stdout);
  % Costs that are not finite come as texts.
  answer = jsondecode(strrep(strrep(input("", "s"), '"inf"', "Infinity"), '"nan"', "NaN"));
  if isfield(answer, "stop")
    break
  end
  [lowest, k] = min(answer.cost);
  if lowest < least
    least = lowest;
    best = points(k, :);
    radius = min(0.5, 1.2 * radius);
  else
    radius = 0.7 * radius;
  end
end
