#!/usr/bin/env bash
# Ninja's lines on standard input, with NINJA_STATUS='%f %t %e ' (done, all, seconds so far), to one line that says how far it is and
# how long the rest may take: drawn anew on a terminal, elsewhere a line at every tenth part.
terminal=0
[ ! -t 1 ] || terminal=1
exec awk -v terminal="$terminal" '
    function text() {
        rest = done > 0 ? seconds * (all - done) / done : 0
        if (done < all * 0.05 || seconds < 2) return sprintf("building: %d of %d", done, all)
        if (rest < 60) return sprintf("building: %d of %d, less than a minute to go", done, all)
        return sprintf("building: %d of %d, about %d min to go", done, all, rest / 60 + 0.5)
    }
    /Re-checking globbed|Re-running CMake/ { next }  # of every build, also where nothing is to be done
    $1 ~ /^[0-9]+$/ && $2 ~ /^[0-9]+$/ && $3 ~ /^[0-9.]+$/ {
        done = $1; all = $2; seconds = $3
        if (terminal) {
            printf "\r\033[K%s", text()
        } else if (int(10 * done / all) > tenth || !begun) {
            print text()
            tenth = int(10 * done / all)
        }
        begun = 1
        fflush()
    }
    END { if (terminal && begun) printf "\r\033[K" }'
