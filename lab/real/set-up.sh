#!/bin/sh
# Installs the programs that people use on models, by the exact versions that stand here, into FOLDER.
# The Containerfile names the shared libraries that they load.
#
# usage: set-up.sh FOLDER [--blender]
set -eu
folder=$1 blender=${2:-}
here=$(dirname "$0")

mkdir -p "$folder"
if ! cmp -s "$here/package-lock.json" "$folder/package-lock.json" || [ ! -d "$folder/node_modules" ]; then
  cp "$here"/package*.json "$folder"
  (cd "$folder" && npm ci --no-audit --no-fund) || { rm -rf "$folder/node_modules"; exit 1; }
fi
cp "$here"/* "$folder" # beside the packages that the scripts import

# environment NAME REQUIREMENTS MODULES: a virtual environment, and that its modules load.
environment() {
  [ -x "$folder/$1/bin/pip" ] || python3 -m venv --clear "$folder/$1"
  "$folder/$1/bin/pip" install --quiet --no-deps --requirement "$here/$2"
  "$folder/$1/bin/python" -c "import $3"
}
environment python requirements.txt "fast_simplification, open3d, pymeshlab, trimesh"
if [ "$blender" = --blender ]; then
  environment blender requirements-blender.txt bpy
fi
