"""blender --background --python blender_readback.py -- FILE.glb FRAMES.f32 FRAME_RATE

Imports our glTF, evaluates every frame, and fails unless the skin equals ours to 1e-5 m.
"""
import array
import sys

import bpy
import numpy

# Debian 12's importer still uses the name that its numpy has dropped.
if "bool" not in vars(numpy):
    numpy.bool = bool

TOLERANCE_M = 1e-5


def main():
    glb, expected_path, rate = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = int(rate)
    bpy.ops.import_scene.gltf(filepath=glb, merge_vertices=False)
    skin = next(o for o in scene.objects if o.type == "MESH" and o.name == "skin")
    expected = array.array("f")
    with open(expected_path, "rb") as file:
        expected.frombytes(file.read())
    count = len(skin.data.vertices)
    frames = len(expected) // (3 * count)
    assert frames * 3 * count == len(expected), "vertex count differs"
    assert frames > 1
    largest = 0.0
    for frame in range(frames):
        scene.frame_set(frame)
        mesh = skin.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        for index, vertex in enumerate(mesh.vertices):
            # Blender turns y up into z up.
            found = skin.matrix_world @ vertex.co
            x, y, z = expected[3 * (frame * count + index):][:3]
            largest = max(largest, abs(found.x - x), abs(found.z - y), abs(-found.y - z))
    if largest > TOLERANCE_M:
        sys.exit(f"largest difference {largest} m")


main()
