"""Runs inside Blender: models to arrays, the scene, and one set of raw pictures per frame.

blender -b --factory-startup -P render.py -- BUILD_FOLDER [--scene N] [--frames A,B,…] [--scale S] [--samples N] [--photo-only | --truth-only]

Writes BUILD_FOLDER/model_ID.npz, and for each frame BUILD_FOLDER/raw/SCENE_FRAME_photo.npz (linear light, normal, albedo) and
SCENE_FRAME_truth.npz: from separate renders without blur and with one ray through each pixel's centre, depth, object numbers
and each object's whole mask.
"""

import argparse
import sys
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Vector

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import random  # noqa: E402

import build_scene  # noqa: E402
import camera as path  # noqa: E402
import materials  # noqa: E402
import meshes  # noqa: E402


# What lies where the car drives in the second scene.
IN_THE_WAY = ["spoon", "kitchen cloth", "pencil b body", "pencil b cone", "pencil b tip"]


def main():
    options = arguments()
    build = Path(options.build)
    (build / "raw").mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    texture = load_texture(build / "obj_000001.png")
    models = meshes.all_models(texture)
    save_models(models, build)
    library = materials.Library(build / "obj_000001.png")
    placed = {model.obj_id: meshes.to_blender(model, library) for model in models}
    generator = random.Random(20)
    build_scene.table(generator)
    build_scene.room()
    build_scene.light()
    build_scene.clutter(build, generator)
    eye = make_camera(options.scale)
    for scene_id, (cameras, poses) in path.sequences().items():
        if options.scene not in (0, scene_id):
            continue
        for frame in range(len(cameras)):
            if options.frames and str(frame) not in options.frames.split(","):
                continue
            for name in IN_THE_WAY:
                bpy.data.objects[name].hide_render = scene_id == 2
            place(eye, placed, cameras[frame], poses[frame])
            shoot(build, f"{scene_id:06d}_{frame:06d}", placed, eye, options, scene_id == 2)


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("build")
    parser.add_argument("--scene", type=int, default=0, help="0: all")
    parser.add_argument("--frames", default="", help="all if not given")
    parser.add_argument("--scale", type=int, default=100, help="percent; less than 100 is for looking only")
    parser.add_argument("--samples", type=int, default=20)
    parser.add_argument("--photo-only", action="store_true")
    parser.add_argument("--truth-only", action="store_true")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def load_texture(file):
    image = bpy.data.images.load(str(file))
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return np.rint(pixels.reshape(height, width, 4)[::-1] * 255.0).astype(np.uint8)


def save_models(models, build):
    for model in models:
        fields = {
            "positions": model.positions,
            "normals": model.normals,
            "colors": model.colors,
            "triangles": model.triangles,
        }
        if model.uvs is not None:
            fields["uvs"] = model.uvs
        np.savez(
            build / f"model_{model.obj_id:06d}.npz",
            name=model.name,
            texture=model.texture or "",
            symmetries_discrete=np.array(model.symmetries_discrete, np.float64),
            continuous=bool(model.symmetries_continuous),
            **fields,
        )


def make_camera(scale):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.sensor_width, data.lens = "HORIZONTAL", path.SENSOR_MM, path.LENS_MM
    data.shift_x, data.shift_y = path.SHIFT_X, path.SHIFT_Y
    data.clip_start, data.clip_end = 0.05, 50.0
    data.dof.aperture_fstop = path.FOCUS_FNUMBER
    data.dof.aperture_blades = 7
    eye = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(eye)
    scene = bpy.context.scene
    scene.camera = eye
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = path.WIDTH, path.HEIGHT, scale
    render.pixel_aspect_x, render.pixel_aspect_y = 1.0, path.PIXEL_ASPECT
    render.use_persistent_data = True
    scene.cycles.use_denoising = False  # develop.py does it: not every build has a denoiser
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.threads_mode, render.threads = "FIXED", 2
    scene.view_settings.view_transform = "Standard"
    return eye


def place(eye, placed, camera_from_world, poses):
    """The truth is in double precision and proper; the renderer gets it rounded to 32 bits."""
    rotation, translation = camera_from_world
    world_from_camera = np.eye(4)
    # Blender's camera looks along -z with y up.
    world_from_camera[:3, :3] = rotation.T @ np.diag([1.0, -1.0, -1.0])
    world_from_camera[:3, 3] = -rotation.T @ translation / 1000.0
    eye.matrix_world = Matrix(world_from_camera.tolist())
    # Focused between the nearest and the farthest object.
    depths = [(rotation @ t + translation)[2] for _, t in poses.values()]
    eye.data.dof.focus_distance = (0.55 * min(depths) + 0.45 * max(depths)) / 1000.0
    for obj_id, (object_rotation, object_translation) in poses.items():
        world_from_object = np.eye(4)
        world_from_object[:3, :3] = object_rotation
        world_from_object[:3, 3] = object_translation / 1000.0
        placed[obj_id].matrix_world = Matrix(world_from_object.tolist())


def shoot(build, name, placed, eye, options, on_tripod):
    if not options.photo_only:
        np.savez_compressed(build / "raw" / f"{name}_truth.npz", **exact(build, placed, eye))
    if not options.truth_only:
        photo = (
            photograph_on_tripod(build, placed, eye, options) if on_tripod else photograph(build, eye, options.samples)
        )
        np.savez(build / "raw" / f"{name}_photo.npz", photo=photo[..., :9])


def photograph_on_tripod(build, placed, eye, options):
    """Only what is around the car and its shadow is rendered anew; the rest is one picture without the car."""
    car = placed[path.CAR]
    plate_file = build / "raw" / "plate.npy"
    if not plate_file.exists():
        car.hide_render = True
        np.save(plate_file, photograph(build, eye, options.samples))
        car.hide_render = False
    corners = [car.matrix_world @ Vector(corner) for corner in car.bound_box]
    shadow = [Vector((corner.x + 0.14, corner.y + 0.02, 0.0)) for corner in corners]
    limit_to(corners + shadow, eye, 0.035)
    part = photograph(build, eye, options.samples)
    bpy.context.scene.render.use_border = False
    return np.where(part[..., 9:] > 0.5, part, np.load(plate_file))


def photograph(build, eye, samples):
    scene = bpy.context.scene
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling = samples, False
    # One bounce traced, later ones taken from the room's mean light: a third faster, and hardly to be told apart.
    cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = 3, 1, 2
    cycles.use_fast_gi, cycles.ao_bounces_render = True, 1
    cycles.sample_clamp_indirect = 3.0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.blur_glossy = 0.5
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 1.5
    cycles.seed = 1
    eye.data.dof.use_dof = True
    layer = bpy.context.view_layer
    layer.use_pass_normal = layer.use_pass_diffuse_color = True
    layer.use_pass_object_index = layer.use_pass_z = False
    wanted = {"photo": "Image", "normal": "Normal", "albedo": "DiffCol"}
    found = render_passes(build, wanted)
    parts = [found["photo"][..., :3], found["normal"][..., :3], found["albedo"][..., :3], found["photo"][..., 3:]]
    return np.concatenate(parts, axis=2).astype(np.float16)


def exact(build, placed, eye):
    """One ray through the centre of each pixel: a filter a hundredth of a pixel wide, and no lens."""
    scene = bpy.context.scene
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling = 1, False
    cycles.max_bounces = 0
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 0.01
    eye.data.dof.use_dof = False
    layer = bpy.context.view_layer
    layer.use_pass_normal = layer.use_pass_diffuse_color = False
    layer.use_pass_object_index = layer.use_pass_z = True
    wanted = {"depth": "Depth", "ids": "IndexOB"}
    found = render_passes(build, wanted)
    truth = {
        "depth_mm": found["depth"][..., 0].astype(np.float64) * 1000.0,
        "ids": np.rint(found["ids"][..., 0]).astype(np.uint8),
    }
    # One by one for what an object would cover if nothing stood before it.
    everything = [each for each in scene.objects if each.type in ("MESH", "CURVE")]
    shown = {each: each.hide_render for each in everything}
    for obj_id, alone in placed.items():
        for each in everything:
            each.hide_render = each is not alone
        limit_to([alone.matrix_world @ vertex.co for vertex in alone.data.vertices], eye, 0.01)
        truth[f"mask_{obj_id}"] = np.packbits(
            np.rint(render_passes(build, {"ids": "IndexOB"})["ids"][..., 0]) == obj_id, axis=1
        )
    scene.render.use_border = False
    for each, hidden in shown.items():
        each.hide_render = hidden
    return truth


def limit_to(points, eye, margin):
    """Renders only the rectangle around some points of the world. It is there to save time."""
    scene = bpy.context.scene
    seen = [world_to_camera_view(scene, eye, point) for point in points]
    render = scene.render
    render.use_border, render.use_crop_to_border = True, False
    render.border_min_x, render.border_max_x = min(p.x for p in seen) - margin, max(p.x for p in seen) + margin
    render.border_min_y, render.border_max_y = min(p.y for p in seen) - margin, max(p.y for p in seen) + margin


def render_passes(build, wanted):
    """Renders once and returns the passes as arrays, rows from the top."""
    scene = bpy.context.scene
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    layers = tree.nodes.new("CompositorNodeRLayers")
    output = tree.nodes.new("CompositorNodeOutputFile")
    output.base_path = str(build / "passes")
    output.format.file_format, output.format.color_depth, output.format.exr_codec = "OPEN_EXR", "32", "ZIP"
    output.file_slots.clear()
    for name, render_pass in wanted.items():
        output.file_slots.new(name)
        tree.links.new(layers.outputs[render_pass], output.inputs[name])
    scene.frame_set(1)
    bpy.ops.render.render()
    return {name: read_exr(build / "passes" / f"{name}0001.exr") for name in wanted}


def read_exr(file):
    image = bpy.data.images.load(str(file), check_existing=False)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    pixels = np.empty(width * height * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[::-1]


main()
