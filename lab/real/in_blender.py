"""Import, one operation on every mesh, export: in_blender.py SOURCE TARGET re-export|transform_apply|MODIFIER [NAME=VALUE ...]

Before a modifier, vertices at one position are merged, as an artist would. N% is of the mesh's own diagonal."""

import math
import sys

import bpy  # brings bmesh
import bmesh


def main(source, target, operation, *words):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=source)
    if operation != "re-export":
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.object.make_single_user(object=True, obdata=True)
    if operation == "transform_apply":
        bpy.ops.object.transform_apply()
    elif operation != "re-export":
        for thing in bpy.data.objects:
            if thing.type == "MESH":
                merge(thing.data)
                modify(thing, operation, words)
    bpy.ops.export_scene.gltf(filepath=target, export_format="GLB")


def merge(mesh):
    editable = bmesh.new()
    editable.from_mesh(mesh)
    bmesh.ops.remove_doubles(editable, verts=editable.verts, dist=0)
    editable.to_mesh(mesh)


def modify(thing, operation, words):
    corners = thing.bound_box
    modifier = thing.modifiers.new(operation, operation)
    for name, value in (word.split("=") for word in words):
        if value.endswith("%"):
            value = float(value[:-1]) / 100 * math.dist(corners[0], corners[6])
        setattr(modifier, name, type(getattr(modifier, name))(value))
    thing.modifiers.move(len(thing.modifiers) - 1, 0)  # before those that came with the file
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.modifier_apply(modifier=modifier.name)


main(*sys.argv[1:])
