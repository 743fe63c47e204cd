"""blender --background --python blender_readback.py -- FILE.glb FRAMES.f32 FRAME_RATE OBJECT ...

Imports our glTF, evaluates every frame, and fails unless the objects equal ours to 1e-5 m. A frame
has the vertices of one object after the other, in the order given.
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
    glb, expected_path, rate, *names = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = int(rate)
    bpy.ops.import_scene.gltf(filepath=glb, merge_vertices=False)
    objects = [scene.objects[name] for name in names]
    expected = array.array("f")
    with open(expected_path, "rb") as file:
        expected.frombytes(file.read())
    count = sum(len(o.data.vertices) for o in objects)
    frames = len(expected) // (3 * count)
    assert frames * 3 * count == len(expected), "vertex count differs"
    assert frames > 1
    largest = 0.0
    for frame in range(frames):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        index = frame * count
        for o in objects:
            for vertex in o.evaluated_get(graph).to_mesh().vertices:
                # Blender turns y up into z up.
                found = o.matrix_world @ vertex.co
                x, y, z = expected[3 * index:][:3]
                largest = max(largest, abs(found.x - x), abs(found.z - y), abs(-found.y - z))
                index += 1
    if largest > TOLERANCE_M:
        sys.exit(f"largest difference {largest} m")


main()
