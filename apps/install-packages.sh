#!/bin/sh
# Installs those of the named Debian packages that are missing; silent where none is.
set -eu
missing=""
for package in "$@"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed' || missing="$missing $package"
done
[ -n "$missing" ] || exit 0
as_root=""
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "Saccade needs these Debian packages, and sudo is not here to install them:$missing" >&2; exit 1; }
  as_root=sudo
fi
echo "Installing Debian packages:$missing" >&2
$as_root apt-get update -qq
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
