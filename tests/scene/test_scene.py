"""Scenes, cameras and materials: what they hold, refuse, and become as arrays."""

import numpy as np
import pytest
import trimesh
from shadelab.light import PointLight, RectLight
from shadelab.mesh import Mesh, box, icosphere, plane
from shadelab.scene import Camera, Instance, Material, Scene, default, fit_camera
from shadelab.transform import project, rotate_axis, scale, translate


def test_rays_go_through_the_centres_of_their_pixels():
    camera = Camera((1.0, 2.0, 5.0), (0.2, 0.1, -0.3), up=(0.2, 1.0, 0.1), fov_y=0.9)
    size = (40, 30)
    origins, directions = camera.rays(size)
    assert origins.shape == directions.shape == (30, 40, 3)
    assert np.abs(np.linalg.norm(directions, axis=-1) - 1).max() < 1e-15
    matrix = camera.projection(40 / 30) @ camera.view()
    pixels = project(origins + 3 * directions, matrix, size)
    j, i = np.meshgrid(np.arange(40) + 0.5, np.arange(30) + 0.5)
    assert np.abs(pixels[..., 0] - j).max() < 1e-11 and np.abs(pixels[..., 1] - i).max() < 1e-11
    single = camera.rays(size, dtype=np.float32)[1]
    assert single.dtype == np.float32 and np.abs(single - directions).max() < 3e-7


def test_a_fitted_camera_sees_everything():
    rng = np.random.default_rng(1)
    for _ in range(20):
        thing = Mesh(rng.normal(size=(12, 3)) * rng.uniform(0.01, 100, 3) + rng.normal(size=3) * 50, [[0, 1, 2]])
        camera = Scene(thing).camera
        pixels = project(thing.positions[:3], camera.projection(1.0) @ camera.view(), (100, 100))
        assert (pixels[:, :2] >= 0).all() and (pixels[:, :2] <= 100).all()


def test_a_camera_is_fitted_to_boxes_of_any_size():
    for size in (1e-200, 1e200):
        camera = fit_camera([[-size] * 3, [size] * 3])
        assert np.isfinite(camera.eye).all() and camera.eye[2] > size
    with pytest.raises(ValueError, match="bounds: expected a box"):
        fit_camera([[-1e308] * 3, [1e308] * 3])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_flatten_puts_instances_into_the_world(dtype):
    red, blue = Material((1, 0, 0), name="red"), Material((0, 0, 1), metallic=1.0, roughness=0.25, emission=(1, 2, 3))
    two = Mesh(box().positions, box().faces, box().normals, material_ids=[0] * 6 + [1] * 6)
    turn = translate([1.0, 2.0, 3.0]) @ rotate_axis([1.0, 1.0, 0.0], 0.7)
    scene = Scene([Instance(two, turn, (red, blue)), Instance(icosphere(1), None, blue), plane(4.0)])
    flat = scene.flatten(dtype)
    assert flat.positions.dtype == flat.normals.dtype == flat.base_color.dtype == dtype
    assert len(flat.faces) == 12 + 80 + 2 and np.array_equal(np.bincount(flat.instance_ids), [12, 80, 2])
    assert flat.materials == (red, blue, Material())
    assert np.array_equal(flat.material_ids, [0] * 6 + [1] * 6 + [1] * 80 + [2] * 2)
    assert np.array_equal(flat.emission[1], [1, 2, 3]) and flat.roughness[1] == 0.25 and flat.metallic[1] == 1
    expected = np.c_[two.positions, np.ones(24)] @ turn.T
    assert np.abs(flat.positions[:24] - expected[:, :3]).max() < 8 * np.finfo(dtype).eps
    world = trimesh.Trimesh(flat.positions[flat.faces[:12]].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert world.volume == pytest.approx(1, rel=1e-5)
    assert np.abs(np.linalg.norm(flat.normals, axis=-1) - 1).max() < 4 * np.finfo(dtype).eps
    assert flat.colors is None


def test_missing_colours_are_white_beside_given_ones():
    colored = Mesh(box().positions, box().faces, colors=np.full((24, 3), 0.25))
    flat = Scene([box(), colored]).flatten()
    assert np.array_equal(flat.colors, np.repeat([1.0, 0.25], 24)[:, None] * np.ones(3))


def test_a_mirrored_instance_keeps_its_outside():
    flat = Scene(Instance(icosphere(2), np.diag([-1.0, 1, 1, 1]))).flatten()
    assert trimesh.Trimesh(flat.positions, flat.faces).volume > 0


def test_what_cannot_be_is_refused():
    for make, error, match in [
        (lambda: Material((1.2, 0, 0)), ValueError, "base_color"),
        (lambda: Material(roughness=float("nan")), ValueError, "roughness"),
        (lambda: Camera((0, 0, 0), (0, 0, 0)), ValueError, "target"),
        (lambda: Camera((0, 5, 0), (0, 0, 0)), ValueError, "up: expected a direction not parallel"),
        (lambda: Camera((0, 0, 5), (0, 0, 0), near=2.0, far=1.0), ValueError, "far"),
        (lambda: Instance(box(), np.zeros((4, 4))), ValueError, "transform"),
        (lambda: Instance(Mesh(box().positions, box().faces, material_ids=[1] * 12)), ValueError, "material 1 of 1"),
        (lambda: Scene([1]), TypeError, "instances: expected Instance or Mesh, got int"),
        (lambda: Scene(box(), lights=[box()]), TypeError, "lights: expected lights, got Mesh"),
        (lambda: Scene([]), ValueError, "at least one face"),
        (lambda: Scene(box(), background=(-1, 0, 0)), ValueError, "background"),
        # Single precision holds no more.
        (lambda: Scene(box(), background=(1e39, 0, 0)), ValueError, "background"),
        (lambda: Material(emission=(0, 1e39, 0)), ValueError, "emission"),
    ]:
        with pytest.raises(error, match=match):
            make()


def test_one_light_or_several():
    light = PointLight((0, 2, 0))
    assert Scene(box(), light).lights == Scene(box(), [light]).lights == (light,)


def test_the_default_scene_is_closed_lit_and_framed():
    scene = default()
    assert isinstance(scene.lights[0], RectLight)
    things = scene.instances[1:]
    for thing in things:
        t = trimesh.Trimesh(thing.world().positions, thing.mesh.faces)
        assert t.is_watertight and t.volume > 0
    lows = np.array([thing.world().bounds[0, 1] for thing in things])
    # Box, sphere and post stand on the ground, to rounding and the facets of the sphere; the torus floats.
    assert (np.abs(lows[[0, 1, 3]]) < 2e-3).all() and lows[2] > 0.5
    flat = scene.flatten()
    used = flat.positions[np.unique(flat.faces[flat.instance_ids > 0])]
    pixels = project(used, scene.camera.projection(16 / 9) @ scene.camera.view(), (1280, 720))
    assert (pixels[:, :2] >= 0).all() and (pixels[:, :2] <= [1280, 720]).all()
    # The light shines down at what stands there.
    light = scene.lights[0]
    assert np.dot(np.cross(light.edge_u, light.edge_v), -np.asarray(light.center)) > 0
    assert default().flatten().positions.tobytes() == flat.positions.tobytes()


def test_flattened_instances_have_finite_normals():
    flat = Scene(Instance(box(), scale([1.0, 0.0, 1.0]))).flatten(np.float64)
    length = np.linalg.norm(flat.normals, axis=-1)
    assert np.isfinite(flat.normals).all()
    assert np.all(np.isclose(length, 1) | (length == 0)) and (length > 0).any()
    assert not Scene(Instance(box(), scale([0.0, 0.0, 0.0]))).flatten().normals.any()


def test_no_instances_at_all_are_named():
    for nothing in (None, 5):
        with pytest.raises(TypeError, match="instances: expected Instance or Mesh, or several"):
            Scene(nothing)
