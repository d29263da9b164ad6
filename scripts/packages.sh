#!/usr/bin/env bash
# The one list of the Debian 12 packages Schuler is made of, and the command that installs those that are missing.
#
#   scripts/packages.sh --list [build|test|develop|embedded|site] names, one a line (all sets when none is named)
#   scripts/packages.sh --missing SET                    names that are not installed; exit status 0 when there are none
#   scripts/packages.sh --install SET                    installs what is missing, as root or through sudo
#
# `test` includes `build`, `develop` includes both; `embedded` is what scripts/embedded.sh needs and part of none; so is `site`, of scripts/site.sh. Nothing is done,
# and apt is not called, when nothing is missing.
set -euo pipefail
shopt -s inherit_errexit

build=(
    g++ cmake ninja-build pkg-config
    libeigen3-dev           # linear algebra
    libgeographiclib-dev    # geodesy, normal gravity
    libfmt-dev
    libcli11-dev            # command line
    libtomlplusplus-dev libyaml-cpp-dev nlohmann-json3-dev
    libhdf5-dev zlib1g-dev libfast-float-dev
    libmatio-dev libsqlite3-dev libzstd-dev liblz4-dev libbz2-dev   # MAT-files, ROS 2 databases, compressed blocks of bags and MCAP
    libkissfft-dev
    libboost-dev            # Math: distributions; Multiprecision: ranks decided with a hundred digits
    libcpp-httplib-dev      # the server of `schuler ui`
)
test=(
    ccache
    nodejs npm                      # build the page of `schuler ui`; where they are there in another way, they are not installed
    libgtest-dev libgmock-dev librapidcheck-dev libbenchmark-dev
    clang-16 libclang-rt-16-dev     # libFuzzer and its run-time libraries
    clang-format-16 clang-tidy-16
    rtklib                          # convbin, rnx2rtkp: oracles, never linked
    chromium                        # opens the reports
    python3 python3-numpy python3-scipy
    python3-dev pybind11-dev python3-setuptools python3-pip python3-pandas python3-matplotlib     # the Python package
    python3-nbclient python3-nbformat python3-ipykernel                                           # executes the notebooks
    octave                          # reads run.mat
    fakeroot dpkg-dev               # the Debian package
    mkdocs                          # scripts/site.sh
)
develop=(
    gcovr                           # scripts/coverage.sh
    cppcheck                        # scripts/trust analysis
    python3-mpmath                  # tests/theory/make_equator_table.py
)
embedded=(
    g++ cmake ninja-build libeigen3-dev libfmt-dev libboost-dev python3
    g++-aarch64-linux-gnu g++-arm-linux-gnueabihf qemu-user-static
)
site=(
    mkdocs
    doxygen                         # the C++ interface
)

fail() {
    echo "packages: $*" >&2
    exit 1
}

names_of() {
    case "$1" in
        build) printf '%s\n' "${build[@]}" ;;
        test) printf '%s\n' "${build[@]}" "${test[@]}" ;;
        develop | "") printf '%s\n' "${build[@]}" "${test[@]}" "${develop[@]}" ;;
        embedded) printf '%s\n' "${embedded[@]}" ;;
        site) printf '%s\n' "${site[@]}" ;;
        *) fail "unknown set '$1': build, test, develop, embedded or site" ;;
    esac
}

# Node and npm often come from elsewhere, in packages that exclude Debian's.
without_present() {
    local name present=()
    for name in nodejs:node npm:npm; do
        ! command -v "${name#*:}" >/dev/null || present+=(-e "/^${name%:*}$/d")
    done
    sed -e '' "${present[@]}"
}

# Names of the set that dpkg does not report as installed.
missing_of() {
    local names
    names=$(names_of "$1" | without_present)
    # shellcheck disable=SC2086  # one word a name
    { dpkg-query --show --showformat='${db:Status-Status} ${Package}\n' $names 2>/dev/null || true; } |  # 1: some unknown
        awk -v names="$names" '$1 == "installed" { have[$2] = 1 }
            END { n = split(names, wanted, "\n"); for (i = 1; i <= n; ++i) if (!(wanted[i] in have)) print wanted[i] }'
}

install_set() {
    if ! command -v dpkg-query >/dev/null; then
        echo "packages: this is not a Debian system; the names of what is needed: scripts/packages.sh --list $1" >&2
        return 0
    fi
    local missing
    missing=$(missing_of "$1")
    [ -n "$missing" ] || return 0
    local one_line=${missing//$'\n'/ }
    local as_root=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || fail "missing and neither root nor sudo here; as root: apt-get install $one_line"
        as_root=(sudo)
    fi
    echo "packages: installing $one_line" >&2
    local apt=(env DEBIAN_FRONTEND=noninteractive apt-get --quiet --quiet)
    local log
    log=$(mktemp)
    # shellcheck disable=SC2064
    trap "rm -f '$log'" EXIT
    "${as_root[@]}" "${apt[@]}" update >"$log" 2>&1 ||
        fail "apt-get update failed (no network, or no package source?): $(grep -m1 '^E:' "$log" || tail -n 1 "$log")"
    # shellcheck disable=SC2086
    "${as_root[@]}" "${apt[@]}" install --yes --no-install-recommends -o Dpkg::Use-Pty=0 $missing >"$log" 2>&1 ||
        fail "apt-get install failed: $(grep -m1 '^E:' "$log" || tail -n 1 "$log")"
}

case "${1:-}" in
    --list) names_of "${2:-}" ;;
    --missing)
        missing=$(missing_of "${2:?set: build, test, develop or embedded}")
        [ -z "$missing" ] || { echo "$missing"; exit 1; }
        ;;
    --install) install_set "${2:?set: build, test, develop or embedded}" ;;
    *) sed -n 's/^# \{0,1\}//; 2,9p' "$0" >&2; exit 2 ;;
esac
