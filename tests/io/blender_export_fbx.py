"""blender --background --python blender_export_fbx.py -- FILE.glb FILE.fbx

Makes a rigged, animated FBX out of a glTF.
"""
import sys

import bpy
import numpy

# Debian 12's importer still uses the name that its numpy has dropped.
if "bool" not in vars(numpy):
    numpy.bool = bool

source, target = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source)
bpy.ops.export_scene.fbx(filepath=target, add_leaf_bones=False, bake_anim_simplify_factor=0,
                         path_mode="COPY", embed_textures=True)
