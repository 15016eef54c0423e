"""Models from files: geometry, transforms, normals and base colours as trimesh wrote them; broken files in one line."""

import json

import numpy as np
import pytest
import shadelab as sl
import trimesh
from shadelab.scene import load, load_mesh


@pytest.fixture
def ball():
    return trimesh.creation.icosphere(2)


@pytest.mark.parametrize("suffix", ["obj", "ply", "stl", "glb", "gltf"])
def test_every_format_gives_the_same_solid(ball, suffix, tmp_path):
    path = tmp_path / f"ball.{suffix}"
    ball.export(path)
    m = load_mesh(path)
    t = trimesh.Trimesh(m.positions, m.faces)
    assert t.is_watertight and len(m.faces) == len(ball.faces)
    assert t.volume == pytest.approx(ball.volume, rel=1e-5)  # formats hold single precision or seven digits
    assert np.abs(np.linalg.norm(m.normals, axis=-1) - 1).max() < 1e-12
    # Smooth, also where the format (STL) repeats a vertex for each face.
    assert (np.einsum("ij,ij->i", m.normals, m.positions) > 0.99).all()


def test_nodes_of_a_scene_graph_are_instances_with_transforms_and_materials(tmp_path):
    graph = trimesh.Scene()
    part = trimesh.creation.box()
    part.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(
            name="paint", baseColorFactor=[0.5, 0.25, 0.125, 1.0], metallicFactor=0.75, roughnessFactor=0.25
        )
    )
    for x in (0.0, 3.0):
        matrix = trimesh.transformations.translation_matrix([x, 1, 0])
        graph.add_geometry(part, geom_name="part", node_name=f"at {x}", transform=matrix)
    graph.export(tmp_path / "two.glb")
    scene = load(tmp_path / "two.glb", stage=False)
    assert sorted(i.transform[0, 3] for i in scene.instances) == [0, 3]
    material = scene.instances[0].materials[0]
    assert material.name == "paint" and (material.metallic, material.roughness) == (0.75, 0.25)
    assert np.abs(np.subtract(material.base_color, (0.5, 0.25, 0.125))).max() < 1 / 255


@pytest.mark.parametrize(("suffix", "linear"), [("ply", False), ("glb", True)])
def test_vertex_colours_become_linear_base_colours(ball, suffix, linear, tmp_path):
    codes = np.random.default_rng(1).integers(0, 256, (len(ball.vertices), 4)).astype(np.uint8)
    codes[:, 3] = 255
    ball.visual = trimesh.visual.ColorVisuals(ball, vertex_colors=codes)
    ball.export(tmp_path / f"ball.{suffix}")
    m = load_mesh(tmp_path / f"ball.{suffix}")
    stored = codes[:, :3] / 255
    expected = stored if linear else sl.color.decode_transfer(stored)
    assert np.abs(m.colors - expected).max() < 1e-6


def test_textures_are_taken_at_the_vertices_with_the_origin_at_the_bottom_left(tmp_path):
    from PIL import Image

    pixels = np.zeros((64, 64, 3), np.uint8)
    pixels[:32] = 255  # the top half
    uv = np.array([[0.5, 0.25], [0.5, 0.75], [0.25, 0.75]])
    m = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], process=False)
    m.visual = trimesh.visual.TextureVisuals(
        uv=uv, material=trimesh.visual.material.PBRMaterial(baseColorTexture=Image.fromarray(pixels))
    )
    m.export(tmp_path / "t.glb")
    got = load_mesh(tmp_path / "t.glb")
    assert np.allclose(got.uvs, uv, atol=1e-6)
    assert np.array_equal(got.colors[:, 0], [0, 1, 1])


def test_creases_stay_sharp_where_the_file_has_no_normals(tmp_path):
    trimesh.creation.box().export(tmp_path / "box.obj", include_normals=False)
    m = load_mesh(tmp_path / "box.obj")
    assert np.abs(np.abs(m.normals).max(-1) - 1)[np.unique(m.faces)].max() < 1e-12  # each along an axis


def test_a_model_is_set_on_the_ground_under_a_light(ball, tmp_path):
    ball.apply_translation([5, 7, -3])
    ball.export(tmp_path / "ball.ply")
    scene = load(tmp_path / "ball.ply")
    model, ground = scene.instances
    assert ground.world().bounds[:, 1] == pytest.approx(model.world().bounds[0, 1])
    light = scene.lights[0]
    toward = np.subtract([5, 7, -3], light.center)
    normal = np.cross(light.edge_u, light.edge_v)
    assert np.dot(normal, toward) == pytest.approx(np.linalg.norm(normal) * np.linalg.norm(toward))
    origins, directions = scene.camera.rays((21, 21))
    flat = scene.flatten(np.float64)
    hit = sl.accel.BVH(flat.positions, flat.faces).closest_hit(origins[10, 10], directions[10, 10])
    assert 0 <= hit.face < len(ball.faces)


NO_Y = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n1\n2\n3\n"
NO_BUFFER = b"""{"asset": {"version": "2.0"}, "buffers": [{"uri": "absent.bin", "byteLength": 36}],
"bufferViews": [{"buffer": 0, "byteLength": 36}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}"""


@pytest.mark.parametrize(
    ("name", "content", "error", "match"),
    [
        ("none.obj", None, FileNotFoundError, "none.obj: no such file"),
        ("model.step", b"", ValueError, "unknown format '.step'"),
        ("empty.obj", b"", ValueError, "empty.obj"),
        ("empty.ply", b"", ValueError, "empty.ply: cannot be read as PLY"),
        ("noise.glb", b"\x00\x01\x02noise", ValueError, "noise.glb: cannot be read as GLB"),
        ("noise.stl", b"\xff" * 200, ValueError, "noise.stl"),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n", ValueError, "points.obj"),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", ValueError, "index.obj"),
        ("nan.obj", b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", ValueError, "nan.obj"),
        ("broken.gltf", b"{", ValueError, "broken.gltf: cannot be read as GLTF: it is not JSON"),
        ("l.gltf", b"[]", ValueError, "l.gltf: cannot be read as GLTF: it holds no JSON object"),
        ("m.gltf", NO_BUFFER, ValueError, r"m.gltf: .* a file that it names is missing \(absent.bin\)"),
        ("short.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", ValueError, "short.ply: .* ends too early"),
        ("y.ply", NO_Y, ValueError, "y.ply: cannot be read as PLY: it lacks 'y'"),
        ("same.obj", b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", ValueError, "same.obj: all vertices are at one point"),
        ("far.obj", b"v 1e300 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", ValueError, "far.obj: .* up to 1e.18, got 1e.300"),
    ],
)
def test_what_is_no_model_gives_one_clear_line(name, content, error, match, tmp_path):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(error, match=match) as caught:
        load(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_a_directory_is_no_model(tmp_path):
    (tmp_path / "d.obj").mkdir()
    with pytest.raises(IsADirectoryError, match=r"d\.obj: is a directory"):
        load(tmp_path / "d.obj")


def test_what_obj_says_shines_does(tmp_path):
    (tmp_path / "a.mtl").write_text("newmtl glow\nKd 0.5 0.5 0.5\nKe 5 4 3\nnewmtl odd\nKd 0.1 0.2 0.3\nKe 5 -4 nan\n")
    triangle = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl {}\nf 1 2 3\n"
    for name, expected in (("glow", (5.0, 4.0, 3.0)), ("odd", (0.0, 0.0, 0.0))):
        (tmp_path / "a.obj").write_text(triangle.format(name))
        assert load(tmp_path / "a.obj", stage=False).instances[0].materials[0].emission == expected


@pytest.mark.parametrize("suffix", ["glb", "gltf"])
def test_lights_and_cameras_of_a_file_are_said_to_be_left(ball, suffix, tmp_path):
    path = tmp_path / f"lit.{suffix}"
    ball.export(path)
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little") if suffix == "glb" else len(data)
    start = 20 if suffix == "glb" else 0
    tree = json.loads(data[start : start + length])
    tree["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point"}]}}
    tree["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    if suffix == "glb":
        total = (len(data) - length + len(text)).to_bytes(4, "little")
        text = data[:8] + total + len(text).to_bytes(4, "little") + data[16:20] + text + data[start + length :]
    path.write_bytes(text)
    with pytest.warns(UserWarning, match="its lights and cameras are not read"):
        load(path)


def test_a_file_that_is_no_text_is_said_to_be_none(tmp_path):
    (tmp_path / "x.obj").write_bytes(bytes(range(128, 256)) * 8)
    with pytest.raises(ValueError, match=r"x\.obj: (?!.*charset)"):
        load(tmp_path / "x.obj")


def test_digits_in_quotes_are_no_numbers_and_words_no_flags(ball, tmp_path):
    ball.export(tmp_path / "ball.ply")
    with pytest.raises(TypeError, match="stage: expected True or False"):
        load(tmp_path / "ball.ply", stage="no")
    with pytest.raises(TypeError, match="roughness: expected a number, got str"):
        sl.scene.Material(roughness="0.3")
