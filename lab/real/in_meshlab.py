"""MeshLab's filters by their names, each with its settings: in_meshlab.py SOURCE TARGET FILTER [NAME=VALUE ...] [FILTER ...]"""

import sys

import pymeshlab
import surface

source, target, *words = sys.argv[1:]
meshes = pymeshlab.MeshSet()
meshes.add_mesh(pymeshlab.Mesh(*surface.read(source)))
filters = []
for word in words:
    if "=" in word:
        filters[-1][1].append(surface.setting(word))
    else:
        filters.append((word, []))
for name, settings in filters:
    meshes.apply_filter(name, **dict(settings))
mesh = meshes.current_mesh()
surface.write(target, mesh.vertex_matrix(), mesh.face_matrix())
