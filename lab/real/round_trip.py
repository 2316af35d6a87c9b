"""Into another format and back, by trimesh: round_trip.py SOURCE TARGET FORMAT"""

import sys

import trimesh

source, target, suffix = sys.argv[1:]
between = f"{target}.{suffix}"
trimesh.load_scene(source).to_mesh().export(between)
trimesh.load_scene(between).export(target, file_type="glb")
