#!/bin/sh
# Prints the first interpreter between Python 3.11 and 3.14, the system's default first. Prints nothing when there is none.
for candidate in python3 python3.14 python3.13 python3.12 python3.11 python; do
    if "$candidate" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null; then
        command -v "$candidate"
        exit 0
    fi
done
exit 1
