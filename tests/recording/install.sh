#!/bin/sh
# Installs the packages of package-lock.json into node_modules, when they are not there as locked. usage: install.sh NPM
set -eu
cd "$(dirname "$0")"
if [ -f node_modules/.lock-installed ] && cmp -s package-lock.json node_modules/.lock-installed; then
  echo "node packages: all installed"
  exit 0
fi
"$1" ci --no-audit --no-fund
cp package-lock.json node_modules/.lock-installed
