% A solver for `socket = true`, in MATLAB: matlab -batch gaussian_search_socket
% and in Octave, whose package instrument-control has the same functions: octave-cli --quiet gaussian_search_socket.m
if exist("OCTAVE_VERSION", "builtin")
    pkg load instrument-control
    seed = @(value) randn("twister", value);
else
    seed = @(value) rng(value);
end
peer = tcpclient("127.0.0.1", str2double(getenv("DRIFTLESS_PORT")), "Timeout", 3600);
writeline(peer, jsonencode(struct("token", getenv("DRIFTLESS_TOKEN"))));
opening = jsondecode(char(readline(peer)));
lower = opening.problem.lower(:)';
upper = opening.problem.upper(:)';
count = 32;
seed(opening.seed);
best = (lower + upper) / 2;
least = Inf;
radius = 0.5;
row = ['[' strjoin(repmat({'%.17g'}, 1, numel(lower)), ',') ']'];
writeline(peer, '{"hello":{"name":"gaussian-search","version":"1"}}');
while true
    points = best + radius * (upper - lower) .* randn(count, numel(lower));
    points = min(max(points, lower), upper);
    rows = sprintf([row ','], points');
    writeline(peer, ['{"x":[' rows(1:end-1) ']}']);
    % Costs that are not finite come as texts.
    answer = jsondecode(strrep(strrep(char(readline(peer)), '"inf"', 'Infinity'), '"nan"', 'NaN'));
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
