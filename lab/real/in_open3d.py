"""A method of Open3D's TriangleMesh: in_open3d.py SOURCE TARGET METHOD NAME=VALUE; N% is of the triangles or of the diagonal."""

import sys

import numpy
import open3d
import surface

source, target, method, words = sys.argv[1:]
vertices, faces = surface.read(source)
name, value = surface.setting(words)
if isinstance(value, str):
    share = float(value.removesuffix("%")) / 100
    value = {"target_number_of_triangles": int(share * len(faces)), "voxel_size": share * surface.diagonal(vertices)}[name]
mesh = open3d.geometry.TriangleMesh(
    open3d.utility.Vector3dVector(vertices), open3d.utility.Vector3iVector(faces)
)
mesh = getattr(mesh, method)(**{name: value})
surface.write(target, numpy.asarray(mesh.vertices), numpy.asarray(mesh.triangles))
