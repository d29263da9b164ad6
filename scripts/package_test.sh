#!/usr/bin/env bash
# Makes the Debian package of a build folder and tries it away from the sources: its contents, its dependencies, the same bytes twice;
# then it is unpacked into an empty root, where program, library and Python package run from there and nowhere else.
#
#   scripts/package_test.sh BUILD_FOLDER
#
# As root with debootstrap, `SCHULER_BARE_ROOT=1` installs it into a bare Debian instead (needs the network, a minute or two).
set -euo pipefail
build=$(cd "${1:?build folder}" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "package test: $*" >&2; exit 1; }
begin=$SECONDS

pack() {
    (cd "$build" && SOURCE_DATE_EPOCH=1700000000 cpack -G DEB -B "$1" >"$work/cpack.log" 2>&1) || { cat "$work/cpack.log" >&2; fail "cpack"; }
    rm -rf "$1/_CPack_Packages"
}
pack "$work/one"
pack "$work/two"
deb=$(ls "$work"/one/schuler_*.deb)
cmp "$deb" "$work/two/$(basename "$deb")" || fail "two packages of one build differ"
echo "package: $(basename "$deb"), $(($(stat -c %s "$deb") / 1024)) kB, the same twice"

dpkg-deb --info "$deb" | grep -E '^ (Depends|Recommends):' | cut -c 1-140 >&2
dpkg-deb --info "$deb" >"$work/depends"
for library in libc6 libhdf5 libgeographiclib libmatio libsqlite3 libyaml-cpp; do
    grep -q "Depends:.*$library" "$work/depends" || fail "$library is not among the dependencies"
done
contents=$(dpkg-deb --contents "$deb" | awk '{ print $6 }')
for file in bin/schuler lib/libschuler.a include/schuler/filter/navigator.h share/man/man1/schuler.1 \
    share/bash-completion/completions/schuler share/zsh/site-functions/_schuler share/schuler/wmm2025.wmm share/schuler/octave/schuler_load.m lib/systemd/system/schuler-live.service; do
    grep -Eq "^\./usr/(.*/)?${file##*/}$" <<<"$contents" || fail "$file is not in the package"
done
grep -q 'pkgconfig/schuler\.pc$' <<<"$contents" || fail "schuler.pc is not in the package"
grep -q 'schulerConfig\.cmake$' <<<"$contents" || fail "schulerConfig.cmake is not in the package"
if dpkg-deb --contents "$deb" | awk '{ print $2 }' | grep -qv '^root/root$'; then fail "files of another owner than root"; fi

root="$work/root"
if [ "${SCHULER_BARE_ROOT:-0}" = 1 ]; then
    debootstrap --variant=minbase bookworm "$root" >"$work/debootstrap.log" 2>&1 || { tail -n 5 "$work/debootstrap.log" >&2; fail "debootstrap"; }
    cp "$deb" "$root/tmp/"
    chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get install --yes --quiet --quiet "/tmp/$(basename "$deb")" >"$work/apt.log" 2>&1 ||
        { tail -n 5 "$work/apt.log" >&2; fail "apt-get install in a bare root"; }
    inside=(chroot "$root" env -i PATH=/usr/bin:/bin HOME=/tmp)
    program=schuler python=python3 place=/tmp/demo
else
    dpkg-deb --extract "$deb" "$root"
    inside=(env -i PATH=/usr/bin:/bin HOME="$work")
    program="$root/usr/bin/schuler" python="/usr/bin/python3" place="$work/demo"
fi
"${inside[@]}" "$program" --version | grep -Eq '^schuler [0-9.]+( \([0-9a-f]+(, modified)?\))?$' || fail "--version"
demo=$SECONDS
"${inside[@]}" "$program" demo -o "$place" -q || fail "schuler demo"
[ $((SECONDS - demo)) -lt 60 ] || fail "schuler demo takes $((SECONDS - demo)) s"
result="$place"
[ "${SCHULER_BARE_ROOT:-0}" != 1 ] || result="$root$place"
grep -q '"verdict"' "$result/summary.json" || fail "schuler demo wrote no summary.json"
echo "program: demo in $((SECONDS - demo)) s"

# the page: its server starts from the package, gives the page to who has the token, and ends when it is told to
mkfifo "$work/address"
"${inside[@]}" "$program" ui --port 0 --workspace "${place%/*}/workspace" >"$work/address" &
server=$!
read -r -t 30 line <"$work/address" || { kill "$server"; fail "schuler ui does not say where it is"; }
/usr/bin/python3 -B - "${line##* }" <<'PYTHON' || { kill "$server"; fail "schuler ui from the package"; }
import http.client
import sys
from urllib.parse import urlsplit

place = urlsplit(sys.argv[1])
link = http.client.HTTPConnection(place.hostname, place.port, timeout=30)
link.request("GET", f"{place.path}?{place.query}")
reply = link.getresponse()
reply.read()
cookie = reply.headers["Set-Cookie"].split(";")[0]
for path, part in (("/", b"<html"), ("/api/about", b"version")):
    link = http.client.HTTPConnection(place.hostname, place.port, timeout=30)
    link.request("GET", path, headers={"Cookie": cookie})
    reply = link.getresponse()
    content = reply.read()
    if reply.status != 200 or part not in content:
        sys.exit(f"{path}: {reply.status} {content[:200]!r}")
PYTHON
kill "$server"
wait "$server" || fail "schuler ui ends with $?"
echo "page: served, and ended"

if [ "${SCHULER_BARE_ROOT:-0}" != 1 ]; then
    if [ -d "$root/usr/lib/python3/dist-packages/schuler" ] && "$python" -c "import numpy" 2>/dev/null; then
        cd "$work"
        "${inside[@]}" PYTHONPATH="$root/usr/lib/python3/dist-packages" "$python" -B -c "
import schuler
assert schuler.__file__.startswith('$root'), schuler.__file__
r = schuler.process('$place/dataset', self_check=False)
assert len(r.solution) > 1000 and r.usable
print('python:', schuler.__version__, len(r.solution), 'rows')" || fail "the Python package"
    else
        echo "python: not built, or no NumPy: not tried"
    fi
    printf '#include <schuler/earth/ellipsoid.h>\nint main() { return schuler::earth::radii(schuler::earth::wgs84, 0.0).meridian > 6e6 ? 0 : 1; }\n' >"$work/a.cpp"
    pc=$(dirname "$(find "$root" -name schuler.pc)")
    flags=$(PKG_CONFIG_PATH="$pc" pkg-config --cflags --libs schuler)
    # shellcheck disable=SC2086
    g++ "$work/a.cpp" -o "$work/a" $flags && "$work/a" || fail "a program by pkg-config"
    echo "pkg-config: a program was built and ran"
fi
echo "package test: good, $((SECONDS - begin)) s"
