"""blender --background --python rig_writer_blender.py -- FILE.glb FRAMES.f32 FRAME_RATE MOTION TOLERANCE_M

Imports a baked character, plays one of its animations, and fails unless every vertex of every
fourth frame is where ours is. With a cache beside the file (FILE.pc2, FILE.mdd) MOTION is that
ending: the modifier that plays it is put on the mesh.
"""
import array
import os
import sys

import bpy
import numpy

# Debian 12's importer still uses the name that its numpy has dropped.
if "bool" not in vars(numpy):
    numpy.bool = bool

EVERY = 4


def play(motion):
    """Makes one animation the active one, on bones and on shape keys."""
    owners = list(bpy.data.objects) + list(bpy.data.shape_keys)
    for owner in owners:
        data = owner.animation_data
        if not data:
            continue
        strips = [t.strips[0] for t in data.nla_tracks if t.name == motion]
        data.use_nla = False
        data.action = strips[0].action if strips else None


def add_cache(mesh, path):
    """What the importer does to turn y up into z up, said in the modifier's terms."""
    modifier = mesh.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format = "PC2" if path.endswith("pc2") else "MDD"
    modifier.filepath = path
    modifier.forward_axis = "POS_Z"
    modifier.up_axis = "NEG_Y"
    modifier.frame_start = 0


def main():
    glb, expected_path, rate, motion, tolerance = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = int(rate)
    bpy.ops.import_scene.gltf(filepath=glb, merge_vertices=False)
    meshes = [o for o in scene.objects if o.type == "MESH" and o.visible_get()]
    if motion in ("pc2", "mdd"):
        add_cache(meshes[0], os.path.splitext(glb)[0] + "." + motion)
    else:
        play(motion)
    expected = array.array("f")
    with open(expected_path, "rb") as file:
        expected.frombytes(file.read())
    count = sum(len(m.data.vertices) for m in meshes)
    expected = numpy.array(expected, dtype=numpy.float64)
    assert expected.size % (3 * count) == 0, f"{count} vertices"
    expected = expected.reshape((-1, count, 3))
    assert len(expected) > 1
    largest = 0.0
    for frame in range(0, len(expected), EVERY):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        found = []
        for mesh in meshes:
            posed = mesh.evaluated_get(graph)
            matrix = numpy.array(posed.matrix_world)
            local = numpy.empty(3 * len(mesh.data.vertices), dtype=numpy.float32)
            posed.to_mesh().vertices.foreach_get("co", local)
            found.append(local.reshape((-1, 3)) @ matrix[:3, :3].T + matrix[:3, 3])
        found = numpy.concatenate(found)
        # Blender's z is our y.
        turned = numpy.stack([found[:, 0], found[:, 2], -found[:, 1]], axis=1)
        largest = max(largest, numpy.linalg.norm(turned - expected[frame], axis=1).max())
    if largest > float(tolerance):
        sys.exit(f"largest difference {largest} m")
    print(f"largest difference {largest} m")


main()
