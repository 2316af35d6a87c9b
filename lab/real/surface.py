"""A .glb as one triangle mesh, and back: all nodes' transforms applied, vertices at one position merged."""

import numpy
import trimesh


def read(path):
    """Positions, V x 3, and triangles, F x 3."""
    mesh = trimesh.load_scene(path).to_mesh()
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=None)
    return numpy.asarray(mesh.vertices, float), numpy.asarray(mesh.faces, numpy.int32)


def write(path, vertices, faces):
    trimesh.Trimesh(vertices, faces, process=False).export(path, file_type="glb")


def diagonal(vertices):
    """Of the bounding box."""
    return float(numpy.linalg.norm(numpy.ptp(vertices, axis=0)))


def setting(text):
    """NAME=VALUE as a pair; the value is a number where it looks like one."""
    name, value = text.split("=")
    for kind in (int, float):
        try:
            return name, kind(value)
        except ValueError:
            pass
    return name, value
