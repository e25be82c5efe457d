#!/bin/sh
# A search that waits for 0.05 to 5 seconds, by chance and log-uniformly, and asks for one cost.
read -r first
seed=${first#*\"seed\":}
echo '{"hello":{"name":"wait"}}'
sleep "$(awk -v seed="${seed%%[!0-9]*}" 'BEGIN { srand(seed); rand(); print 0.05 * 100 ^ rand() }')"
echo '{"x":[0,0]}'
read -r _
echo '{"done":true}'
