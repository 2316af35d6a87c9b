#!/bin/sh
# Installs Debian packages, as root or by sudo, and removes none.
#
# usage: apt-install.sh PACKAGE...
set -eu
missing=
for package in "$@"; do
  state=$(dpkg-query --show --showformat='${db:Status-Abbrev}' "$package" 2> /dev/null) || true
  [ "$state" = "ii " ] || missing="$missing $package"
done
[ "$missing" ] || exit 0
if ! command -v apt-get > /dev/null; then
  echo "there is no apt-get to install$missing with"
  exit 1
fi
sudo=
if [ "$(id -u)" != 0 ]; then
  sudo=$(command -v sudo) || { echo "only root can install$missing, and there is no sudo"; exit 1; }
fi
set -x
$sudo env DEBIAN_FRONTEND=noninteractive apt-get --quiet update
$sudo env DEBIAN_FRONTEND=noninteractive apt-get --quiet install --yes --no-install-recommends --no-remove $missing
