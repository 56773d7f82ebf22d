"""What `import hmesh` promises. HMESH_COMMAND may name the command, whose files then have the bytes of the module's."""

import gc
import io
import math
import os
import pickle
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import types
import weakref

import hmesh
import numpy as np
import pytest


def picture(width=120, height=80, channels=3, dtype=np.uint8):
    """A scene with soft and hard edges, of the type's whole range."""
    y, x = np.mgrid[0:height, 0:width].astype(np.float64)
    planes = []
    for c in range(channels):
        soft = 0.5 + 0.3 * np.sin(x / (9 + c) + 2 * np.sin(y / 17)) + 0.1 * np.cos(y / (5 + c))
        disc = (x - width * 0.6) ** 2 + (y - height / 2) ** 2 < (height / (3 + c % 3)) ** 2
        planes.append(np.where(disc, 1 - soft, soft))
    values = np.clip(np.stack(planes, -1), 0, 1)
    if np.dtype(dtype).kind == "f":
        return values.astype(dtype)
    return np.floor(values * np.iinfo(dtype).max + 0.5).astype(dtype)


def unaligned(array):
    """The array at an odd address, as in a file that is mapped."""
    return np.frombuffer(b"\0" + array.tobytes(), array.dtype, array.size, 1).reshape(array.shape)


def same(one, other):
    return (np.array_equal(one.positions, other.positions) and np.array_equal(one.colors, other.colors)
            and np.array_equal(one.faces, other.faces))


def area(mesh):
    p = mesh.positions.astype(np.float64)[mesh.faces]
    a, b, c = p[:, 0], p[:, 1], p[:, 2]
    return np.sum((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])) / 2


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
@pytest.mark.parametrize("channels", range(1, hmesh.max_channels + 1))
def test_every_type_and_number_of_channels(dtype, channels):
    image = picture(channels=channels, dtype=dtype)
    mesh = hmesh.mesh_image(image, vertices=200, effort="fast")
    assert mesh.positions.shape == (200, 2) and mesh.positions.dtype == np.float32
    assert mesh.colors.shape == (200, channels) and mesh.colors.dtype == np.float32
    assert mesh.faces.shape[1] == 3 and mesh.faces.dtype == np.uint32
    assert area(mesh) == 120 * 80
    assert (mesh.width, mesh.height, mesh.channels) == (120, 80, channels)
    assert mesh.report.vertices == 200 and mesh.report.message == ""
    assert hmesh.psnr(mesh, image) == pytest.approx(mesh.report.psnr, abs=1e-3)  # drawn anew, and measured by numpy
    drawn = np.abs(mesh.render().astype(np.float64) - image).max()
    assert mesh.report.max_error == pytest.approx(drawn, rel=1e-4)


def test_grey_images_may_be_flat_arrays():
    image = picture(channels=1)
    assert same(hmesh.mesh_image(image[:, :, 0], vertices=100), hmesh.mesh_image(image, vertices=100))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_strides_do_not_matter(dtype):
    image = picture(dtype=dtype)
    wanted = hmesh.mesh_image(image, vertices=100, effort="draft")
    wide = np.zeros((80, 150, 3), dtype)
    wide[:, 10:130] = image
    tall = np.repeat(image, 2, axis=0)
    read_only = image.copy()
    read_only.flags.writeable = False
    misplaced = unaligned(image)
    four = np.concatenate([image, image[:, :, :1]], axis=2)
    for same_image in (
        np.asfortranarray(image), wide[:, 10:130], tall[::2], image[::-1][::-1], image[::-1].copy()[::-1],
        image[:, ::-1].copy()[:, ::-1], image.transpose(1, 0, 2).copy().transpose(1, 0, 2), image[:, :, ::-1].copy()[:, :, ::-1],
        read_only, misplaced, four[:, :, :3], image.astype(image.dtype.newbyteorder("S")), image.tolist() and image,
    ):
        assert np.array_equal(same_image, image)
        assert same(hmesh.mesh_image(same_image, vertices=100, effort="draft"), wanted)
    mesh = hmesh.Mesh(unaligned(wanted.positions), unaligned(wanted.colors), unaligned(wanted.faces), width=120, height=80)
    mesh.peak = wanted.peak
    assert mesh.positions.flags.aligned and mesh.colors.flags.aligned and mesh.faces.flags.aligned
    assert mesh.tobytes("ply") == wanted.tobytes("ply")
    weights = np.random.default_rng(1).random((80, 120), np.float32)
    assert same(hmesh.mesh_image(image, vertices=100, effort="draft", weights=unaligned(weights)),
                hmesh.mesh_image(image, vertices=100, effort="draft", weights=weights))


def test_columns_turned_into_one_row_are_images():
    row = picture(200, 1)
    turned = row.transpose(1, 0, 2).copy().transpose(1, 0, 2)  # numpy calls it contiguous, and its rows are a pixel apart
    assert turned.flags.c_contiguous and turned.strides[0] < turned.nbytes
    weights = np.linspace(1, 2, 200, dtype=np.float32)
    assert same(hmesh.mesh_image(turned, vertices=30, weights=weights[:, np.newaxis].T),
                hmesh.mesh_image(row, vertices=30, weights=weights.reshape(1, 200)))
    assert hmesh.compact_image(turned, 300).data == hmesh.compact_image(row, 300).data
    bound = {"max_error": 3, "samples": "squares"}
    mask = (np.arange(200) > 20).astype(np.uint8)
    assert same(hmesh.mesh_terrain(turned[:, :, 0].T.copy().T, mask=mask[:, np.newaxis].T, **bound),
                hmesh.mesh_terrain(row[:, :, 0], mask=mask.reshape(1, 200), **bound))


def test_threads_do_not_matter():
    image = picture(400, 300)
    wanted = hmesh.mesh_image(image, percent=1, effort="fast", threads=1)
    for threads in (0, 2, 5):
        assert same(hmesh.mesh_image(image, percent=1, effort="fast", threads=threads), wanted)
    meshes = [None] * 4

    def work(k):
        meshes[k] = hmesh.mesh_image(image, percent=1, effort="fast", threads=2)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(same(mesh, wanted) for mesh in meshes)


def test_out_of_memory_is_an_exception_with_any_number_of_threads():
    pytest.importorskip("resource")
    code = """if True:
        import resource
        import hmesh
        import numpy as np

        image = np.random.default_rng(0).integers(0, 255, (900, 900, 3), dtype=np.uint8)
        meshes = refusals = 0
        for megabytes in range(20, 1000, 3):
            with open("/proc/self/statm") as file:
                size = int(file.read().split()[0]) * resource.getpagesize()
            resource.setrlimit(resource.RLIMIT_AS, (size + (megabytes << 20), resource.RLIM_INFINITY))
            try:
                hmesh.mesh_image(image, percent=1, effort="draft", threads=2)
                meshes += 1
                break
            except MemoryError:
                refusals += 1
            except RuntimeError:  # there was no memory for a thread
                pass
            resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        assert meshes and refusals
    """
    if not os.path.exists("/proc/self/statm"):
        pytest.skip("it is not known how much memory a process has")
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    # The C library ends the process where it has no memory for what a thread needs to throw.
    assert child.returncode == 0 or "thread-local data" in child.stderr, child.stderr


def test_the_bytes_are_those_of_the_command(tmp_path):
    command = os.environ.get("HMESH_COMMAND")
    if not command:
        pytest.skip("HMESH_COMMAND names no command")
    for channels, magic in ((1, b"P5"), (3, b"P6")):
        image = picture(300, 200, channels)
        name = tmp_path / f"image{channels}.pnm"
        name.write_bytes(magic + b"\n300 200\n255\n" + image.tobytes())
        for arguments, options in (([], {}), (["--effort", "draft", "--vertices", "333"], {"effort": "draft", "vertices": 333})):
            out = tmp_path / "mesh.ply"
            subprocess.run([command, "--quiet", name, "-o", out, *arguments], check=True)
            assert hmesh.mesh_image(image, **options).tobytes("ply") == out.read_bytes()
        for arguments, options in (([], {}), (["--no-table"], {"table": False})):
            out = tmp_path / "mesh.hmc"
            subprocess.run([command, "--quiet", name, "-o", out, "--bytes", "900", "--effort", "fast", *arguments], check=True)
            assert hmesh.compact_image(image, 900, effort="fast", **options).data == out.read_bytes()


@pytest.mark.parametrize(
    "options, sentence",
    [
        (dict(vertices=2), "at least 4 vertices"),
        (dict(vertices=10**9), "at most one vertex a pixel"),
        (dict(vertices=10.5), "whole number"),
        (dict(percent=0), "percent"),
        (dict(percent=math.nan), "percent"),
        (dict(psnr=-3), "PSNR"),
        (dict(vertices=10, psnr=30), "both targets"),
        (dict(effort="hard"), "effort must be one of"),
        (dict(effort=3), "effort must be one of"),
        (dict(seed=-1), "seed must be"),
        (dict(tile=3), "tile must be"),
        (dict(tile=10**12), "tile must be"),
        (dict(threads=-1), "threads must be"),
        (dict(threads=10**9), "threads must be"),
        (dict(weights=np.ones((3, 3))), "image's shape"),
        (dict(weights=-np.ones((80, 120))), "weight"),
        (dict(weights=np.zeros((80, 120))), "weight"),
        (dict(channel_weights=[1, 2]), "channel"),
        (dict(periodic="z"), "periodic must be one of"),
        (dict(straight_border=True), "straight_border"),
        (dict(samples="points", periodic="x"), "squares"),
        (dict(premultiplied=True), "alpha"),
        (dict(position_step=0.3), "position_step"),
        (dict(max_vertices=100), "max_vertices"),
        (dict(border_tolerance=1.0), "points"),
    ],
)
def test_refused_options_have_a_sentence(options, sentence):
    with pytest.raises(ValueError, match=sentence):
        hmesh.mesh_image(picture(), **options)


@pytest.mark.parametrize(
    "image, error",
    [
        (np.zeros((0, 0, 3), np.uint8), ValueError),
        (np.zeros((5, 0), np.uint8), ValueError),
        (np.zeros((4, 4, 17), np.uint8), ValueError),
        (np.zeros((4, 4, 0), np.uint8), ValueError),
        (np.zeros((2, 2, 2, 2), np.uint8), ValueError),
        (np.zeros(7, np.uint8), ValueError),
        (np.uint8(3), ValueError),
        (np.zeros((4, 4)), TypeError),
        (np.zeros((4, 4), np.float16), TypeError),
        (np.zeros((4, 4), np.int16), TypeError),
        (np.zeros((4, 4), np.uint32), TypeError),
        (np.zeros((4, 4), bool), TypeError),
        (np.zeros((4, 4), complex), TypeError),
        (np.array([[object()]]), TypeError),
        ("text", TypeError),
        (None, TypeError),
        (np.full((9, 9), np.nan, np.float32), ValueError),
        (np.full((9, 9), np.inf, np.float32), ValueError),
        (np.ma.masked_equal(picture(9, 9), picture(9, 9)[3, 3, 0]), TypeError),
        (np.lib.stride_tricks.as_strided(np.zeros(1, np.uint8), (1, 1 << 20), (1, 0)), ValueError),  # too wide, and one byte
    ],
)
def test_refused_images_have_a_sentence(image, error):
    with pytest.raises(error) as caught:
        hmesh.mesh_image(image)
    assert len(str(caught.value)) > 10


def test_small_images():
    for width, height in ((1, 1), (2, 1), (1, 7), (3, 3)):
        image = np.full((height, width, 3), 77, np.uint8)
        mesh = hmesh.mesh_image(image)
        assert area(mesh) == width * height and mesh.report.psnr == math.inf
        assert np.array_equal(mesh.render(dtype=np.uint8), image)


def test_a_psnr_is_reached_or_said_not_to_be():
    image = picture()
    mesh = hmesh.mesh_image(image, psnr=30, effort="fast")
    assert mesh.report.psnr >= 30 and mesh.report.message == ""
    mesh = hmesh.mesh_image(image, psnr=60, max_vertices=50, effort="draft")
    assert len(mesh.positions) <= 50 and "PSNR" in mesh.report.message


def test_weights_and_channel_weights_change_the_mesh():
    image = picture()
    plain = hmesh.mesh_image(image, vertices=150, effort="fast")
    weights = np.ones((80, 120))
    weights[:, :60] = 20
    left = hmesh.mesh_image(image, vertices=150, effort="fast", weights=weights)
    assert np.sum(left.positions[:, 0] < 60) > np.sum(plain.positions[:, 0] < 60)
    assert not same(hmesh.mesh_image(image, vertices=150, effort="fast", channel_weights=[5, 1, 1]), plain)


def test_periodic_meshes_repeat():
    mesh = hmesh.mesh_image(picture(), vertices=150, effort="fast", periodic="xy")
    assert mesh.periodic == "xy" and area(mesh) == 120 * 80


def test_progress_grows_and_offers_meshes():
    image, told, meshes = picture(), [], []

    def progress(now):
        told.append(now)
        if now.mesh:
            meshes.append(now.mesh())

    mesh = hmesh.mesh_image(image, vertices=300, progress=progress)
    totals = [now.total for now in told]
    assert totals == sorted(totals) and totals[-1] == 1
    assert {"points", "anneal", "colors"} <= {now.stage for now in told}
    assert meshes and all(area(one) == 120 * 80 for one in meshes)
    assert same(meshes[-1], mesh)
    assert same(hmesh.mesh_image(image, vertices=300), mesh)
    with pytest.raises(RuntimeError, match="during the callback"):
        next(now.mesh for now in told if now.mesh)()


def test_a_callback_ends_the_work():
    image = picture(400, 300)
    mesh = hmesh.mesh_image(image, progress=lambda now: now.stage != "anneal")
    assert "cancelled" in mesh.report.message and area(mesh) == 400 * 300

    class Own(Exception):
        pass

    def fails(now):
        if now.stage == "anneal":
            raise Own("enough")

    for threads in (1, 3):
        with pytest.raises(Own, match="enough"):
            hmesh.mesh_image(image, progress=fails, threads=threads)
    with pytest.raises(TypeError):
        hmesh.mesh_image(image, progress=7)
    assert same(hmesh.mesh_image(image, effort="draft"), hmesh.mesh_image(image, effort="draft"))


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_interrupts_end_the_work():
    code = (
        "import hmesh, numpy as np, os, signal, threading\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # shells ignore it for what runs in the background
        "image = np.random.default_rng(1).integers(0, 256, (1500, 1500, 3), np.uint8)\n"
        "threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
        "try:\n"
        "    hmesh.mesh_image(image, effort='best')\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', hmesh.mesh_image(image[:9, :9]).width)\n"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert out.stdout == "interrupted 9\n", out.stderr


@pytest.mark.parametrize("call", [
    "hmesh.mesh_image(image, effort='best')", "hmesh.mesh_image(image, effort='best', threads=2, progress=lambda now: None)",
    "hmesh.compact_image(image, 9000)", "hmesh.mesh_terrain(image[:, :, 0], max_error=90, effort='best')",
    "[hmesh.mesh_image(image[:40, :40]).render(900, 900) for _ in iter(int, 1)]",
])
def test_an_interpreter_ends_while_threads_mesh_that_it_does_not_wait_for(call):
    code = f"""if True:
        import atexit, threading, time
        last = lambda: print(hmesh.mesh_image(image[:9, :9], threads=2, progress=lambda now: None))
        atexit.register(last)  # before hmesh's own, and so called after it
        import hmesh
        import numpy as np

        image = np.random.default_rng(1).integers(0, 256, (900, 900, 3), np.uint8)

        def work():
            {call}
            print("never made")

        threading.Thread(target=work, daemon=True).start()
        time.sleep(0.5)
    """
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert (child.returncode, child.stderr) == (0, "")
    assert child.stdout == "<hmesh.Mesh of 9 x 9 px: 4 vertices, 2 faces, 3 channels>\n"


def test_arrays_outlive_their_mesh_and_nothing_leaks():
    image = picture()
    mesh = hmesh.mesh_image(image, vertices=100, effort="draft")
    positions, base = mesh.positions, weakref.ref(mesh.positions)
    copy = positions.copy()
    del mesh
    gc.collect()
    assert np.array_equal(positions, copy)
    del positions
    gc.collect()
    assert base() is None
    before = sys.getrefcount(image)
    for _ in range(20):
        hmesh.mesh_image(image, vertices=50, effort="draft", weights=None, progress=lambda now: True)
    assert sys.getrefcount(image) == before


def test_meshes_pickle_and_start_others():
    image = picture()
    mesh = hmesh.mesh_image(image, vertices=200, effort="draft")
    again = pickle.loads(pickle.dumps(mesh))
    assert same(again, mesh) and again.report == mesh.report
    better = hmesh.mesh_image(image, vertices=200, start=again)
    assert better.report.psnr > mesh.report.psnr
    own = hmesh.Mesh(mesh.positions, mesh.colors, mesh.faces, width=120, height=80)
    assert np.array_equal(own.render(), mesh.render())
    with pytest.raises(ValueError, match="wide"):
        hmesh.mesh_image(image[:, 1:], vertices=100, start=mesh)


def test_meshes_that_are_none_are_refused():
    points, colors, faces = np.zeros((3, 2)), np.zeros((3, 3)), np.array([[0, 1, 2]])
    for arguments in ((points[:, :1], colors, faces), (points, colors[:2], faces), (points, colors, faces[:, :2]), (points, colors[0], faces)):
        with pytest.raises(ValueError, match="must be"):
            hmesh.Mesh(*arguments, width=4, height=4)
    far = hmesh.Mesh(points, colors, [[0, 1, 9]], width=4, height=4)
    for call in (far.render, lambda: far.tobytes("ply"), lambda: far.tobytes("hmc")):
        with pytest.raises(ValueError, match="names no vertex"):
            call()
    mesh = hmesh.Mesh(points, colors, faces, width=4, height=4)
    mesh.positions = np.zeros((2, 2), np.float32)
    with pytest.raises(ValueError, match="as many colors as positions"):
        mesh.render()
    for bad in (dict(width=0), dict(width=10**6), dict(height=-3)):
        with pytest.raises(ValueError):
            hmesh.mesh_image(picture(), vertices=9).render(**bad)


def test_ply_is_read_back():
    mesh = hmesh.mesh_image(picture(), vertices=123)
    head, body = mesh.tobytes("ply").split(b"end_header\n", 1)
    assert b"element vertex 123" in head
    size = 4 * 3 + 3  # x, y, z and three bytes
    assert b"property uchar red" in head
    for k, (p, c) in enumerate(zip(mesh.positions, mesh.colors)):
        x, y, _, *rgb = struct.unpack_from("<fffBBB", body, size * k)
        assert (x, 80 - y if y != p[1] else y) == (p[0], p[1]) or y == -p[1]
        assert rgb == list(c)


def test_files_are_written_whole_or_not_at_all(tmp_path):
    mesh = hmesh.mesh_image(picture(), vertices=100, effort="draft")
    for ending in ("ply", "obj", "glb", "svg", "html", "pdf", "eps", "hmc"):
        path = tmp_path / f"mesh.{ending}"
        mesh.write(path)
        assert path.read_bytes() == mesh.tobytes(ending)
        file = io.BytesIO()
        mesh.write(file, ending)
        assert file.getvalue() == mesh.tobytes(ending)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == sorted(
        (".ply", ".obj", ".glb", ".svg", ".html", ".pdf", ".eps", ".hmc"))
    old = tmp_path / "mesh.ply"
    before = old.read_bytes()
    with pytest.raises(TypeError, match="no option"):
        mesh.write(old, wireframe=True)
    with pytest.raises(ValueError, match="format must be one of"):
        mesh.write(tmp_path / "mesh.xyz")
    with pytest.raises(ValueError, match="format must be named"):
        mesh.write(io.BytesIO())
    with pytest.raises(FileNotFoundError):
        mesh.write(tmp_path / "nowhere" / "mesh.ply")
    assert old.read_bytes() == before

    class Full(io.RawIOBase):
        def write(self, data):
            raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        mesh.write(Full(), "ply")
    assert len(list(tmp_path.iterdir())) == 8


@pytest.mark.skipif(os.name == "nt", reason="symbolic links and pipes")
def test_links_stay_links_and_pipes_are_written_to(tmp_path):
    mesh = hmesh.mesh_image(picture(), vertices=100, effort="draft")
    wanted = mesh.tobytes("ply")
    (tmp_path / "real.ply").write_bytes(b"old")
    (tmp_path / "real.ply").chmod(0o640)
    (tmp_path / "link.ply").symlink_to("real.ply")
    (tmp_path / "new.ply").symlink_to("later.ply")
    for name, file in (("link", "real"), ("new", "later")):
        mesh.write(tmp_path / f"{name}.ply")
        assert (tmp_path / f"{name}.ply").is_symlink() and (tmp_path / f"{file}.ply").read_bytes() == wanted
    assert (tmp_path / "real.ply").stat().st_mode & 0o777 == 0o640
    pipe = tmp_path / "pipe.ply"
    os.mkfifo(pipe)
    read = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()), daemon=True)
    reader.start()
    mesh.write(pipe)
    reader.join(20)
    assert read == [wanted] and pipe.is_fifo()
    mesh.write(tmp_path / f"{'n' * 251}.ply")  # as long as names may be
    end, begin = os.pipe()  # as /dev/stdout may be
    mesh.write(f"/dev/fd/{begin}", "ply")
    os.close(begin)
    with open(end, "rb") as file:
        assert file.read() == wanted


def test_compact_files_come_back():
    for channels in (1, 3):
        mesh = hmesh.mesh_image(picture(channels=channels), vertices=150)
        data = mesh.tobytes("hmc")
        again = hmesh.read(data)
        assert again.tobytes("hmc") == data
        assert np.array_equal(again.render(), mesh.render())
    for bad in (b"", b"HMC", data[:-1], data[:40] + bytes([data[40] ^ 1]) + data[41:]):
        with pytest.raises(ValueError):
            hmesh.read(bad)
    with pytest.raises(ValueError, match="vertices"):
        hmesh.read(data, max_vertices=10)


@pytest.mark.parametrize("channels", range(1, min(4, hmesh.max_channels) + 1))
def test_an_image_in_so_many_bytes(channels):
    image = picture(channels=channels)
    file = hmesh.compact_image(image, 900, effort="fast")
    assert 882 <= len(file.data) <= 900
    assert same(hmesh.read(file.data), file.mesh) and file.mesh.channels == channels
    drawn = file.mesh.render(dtype=np.uint8).astype(np.float64)
    assert file.psnr == pytest.approx(10 * math.log10(255**2 / np.mean((drawn - image) ** 2)), abs=1e-9)
    assert hmesh.compact_image(image, bytes=900, effort="fast", threads=3).data == file.data
    assert hmesh.compact_image(image, 900, effort="fast", table=False).data != file.data
    wide = hmesh.compact_image(image.astype(np.uint16) * 257, 900, effort="draft")
    assert wide.data == hmesh.compact_image(image, 900, effort="draft").data


def test_bytes_that_cannot_be():
    image = picture()
    with pytest.raises(ValueError, match="even of 4 vertices"):
        hmesh.compact_image(image, 20)
    for bad in (0, -1, 2.5, True, "300"):
        with pytest.raises(ValueError, match="bytes must be a whole number"):
            hmesh.compact_image(image, bad)
    with pytest.raises(ValueError, match="1 to 4 channels"):
        hmesh.compact_image(np.zeros((8, 8, 5), np.uint8), 300)
    with pytest.raises(ValueError, match="cancel"):
        hmesh.compact_image(image, 300, progress=lambda progress: False)
    totals = []
    hmesh.compact_image(image, 300, effort="draft", progress=lambda progress: totals.append(progress.total))
    assert totals == sorted(totals) and totals[-1] == 1


def test_terrain_keeps_its_bound():
    y, x = np.mgrid[0:90, 0:110]
    heights = (500 + 90 * np.sin(x / 11) * np.cos(y / 9)).astype(np.float32)
    mesh = hmesh.mesh_terrain(heights, max_error=2)
    drawn = mesh.render()[:, :, 0]
    assert np.abs(drawn - heights).max() <= 2 * (1 + 1e-6)
    assert mesh.report.max_error <= 2 and mesh.samples == "points" and len(mesh.faces) < 4000
    holes = heights.copy()
    holes[20:40, 30:60] = np.nan
    with pytest.raises(ValueError):
        hmesh.mesh_terrain(holes, max_error=2)
    fewer = hmesh.mesh_terrain(holes, max_error=2, nan_is_no_data=True)
    masked = hmesh.mesh_terrain(np.nan_to_num(holes), max_error=2, mask=~np.isnan(holes))
    assert same(fewer, masked) and area(fewer) < area(mesh)
    for name in ("stl", "height_ply", "height_obj", "height_glb"):
        assert mesh.tobytes(name, z_scale=0.5)
    assert len(mesh.tobytes("stl", base=0)) > len(mesh.tobytes("stl"))
    for name in ("stl", "height_ply", "height_obj", "height_glb"):  # said with the interpreter's lock, or this ends the process
        with pytest.raises(TypeError, match="z_scale must be a number, and is None"):
            mesh.tobytes(name, z_scale=None)
    for bad in (-1, math.nan):
        with pytest.raises(ValueError, match="max_error"):
            hmesh.mesh_terrain(heights, max_error=bad)
    with pytest.raises(ValueError, match="1 channels"):
        hmesh.mesh_terrain(picture(), max_error=1)


def test_pictures_of_other_sizes_and_types():
    image = picture(dtype=np.uint16)
    mesh = hmesh.mesh_image(image, vertices=300)
    assert mesh.render(60, 40).shape == (40, 60, 3)
    eight, sixteen = mesh.render(dtype=np.uint8), mesh.render(dtype=np.uint16)
    assert eight.dtype == np.uint8 and np.abs(eight * 257.0 - sixteen).max() <= 129
    with pytest.raises(TypeError, match="float32, uint8 or uint16"):
        mesh.render(dtype=np.int32)
    with pytest.raises(ValueError, match="too many pixels"):
        mesh.render(65536, 4097)  # 2^28 and more


def test_pictures_are_rounded_as_their_numbers_are():
    mesh = hmesh.mesh_image(picture(300, 200, dtype=np.float32), vertices=300, effort="draft")
    exact = np.floor(mesh.render().astype(np.float64) * 65535 + 0.5)  # as floats, some would be on the other side of a half
    assert np.array_equal(mesh.render(dtype=np.uint16), np.clip(exact, 0, 65535))


def test_psnr_of_premultiplied_meshes_is_of_the_premultiplied_image():
    image = picture(channels=4)
    mesh = hmesh.mesh_image(image, vertices=200, premultiplied=True)
    assert hmesh.psnr(mesh, image) == pytest.approx(mesh.report.psnr, abs=1e-3)


def test_psnr_of_what_is_not_finite_is_refused():
    image = picture(dtype=np.float32)
    mesh = hmesh.mesh_image(image, vertices=50)
    for bad in (np.inf, -np.inf, np.nan):
        image[3, 4, 1] = bad
        with pytest.raises(ValueError, match="not finite"):
            hmesh.psnr(mesh, image)


def test_masks_of_arrays_are_refused_where_they_mask_anything():
    image = picture(30, 20)
    mask = np.zeros((20, 30), bool)
    assert same(hmesh.mesh_image(np.ma.array(image), vertices=50), hmesh.mesh_image(image, vertices=50))
    mask[2, 3] = True
    with pytest.raises(TypeError, match="weights must be numbers, and some are masked"):
        hmesh.mesh_image(image, weights=np.ma.array(np.ones((20, 30)), mask=mask))
    with pytest.raises(TypeError, match="mask must be numbers, and some are masked"):
        hmesh.mesh_terrain(image[:, :, 0], max_error=2, mask=np.ma.array(np.ones((20, 30)), mask=mask))
    with pytest.raises(TypeError, match="no masked samples"):
        hmesh.mesh_terrain(np.ma.array(image[:, :, 0], mask=mask), max_error=2)
    mesh = hmesh.mesh_image(image, vertices=50, effort="draft")
    for name in ("positions", "colors", "faces"):
        arrays = {one: np.ma.array(getattr(mesh, one)) for one in ("positions", "colors", "faces")}
        assert same(hmesh.Mesh(**arrays, width=30, height=20), mesh)
        arrays[name][3, 1] = np.ma.masked
        with pytest.raises(TypeError, match=f"{name} must be numbers, and some are masked"):
            hmesh.Mesh(**arrays, width=30, height=20)
        other = pickle.loads(pickle.dumps(mesh))
        setattr(other, name, arrays[name])
        with pytest.raises(TypeError, match=f"{name} must be numbers, and some are masked"):
            other.render()


def test_options_of_a_wrong_type_have_a_sentence():
    image = picture()
    mesh = hmesh.mesh_image(image, vertices=100, effort="draft")
    assert hmesh.mesh_image(image, psnr=20, max_vertices=1e3, effort="draft").report.message == ""  # whole numbers, as floats are
    for sentence, call in (
        ("max_vertices must be a whole number", lambda: hmesh.mesh_image(image, psnr=20, max_vertices=10.5)),
        ("good_enough must be a number, and is of type int", lambda: hmesh.mesh_image(image, vertices=9, good_enough=10**5000)),
        ("seed must be a whole number from 0", lambda: hmesh.mesh_image(image, vertices=9, seed=np.float64(2**64))),
        ("good_enough must be a number, and is 'a'", lambda: hmesh.mesh_image(image, vertices=9, good_enough="a")),
        ("border_tolerance must be a number, and is 'a'", lambda: hmesh.mesh_image(image, border_tolerance="a")),
        ("vertices must be a whole number, and is inf", lambda: hmesh.mesh_image(image, vertices=math.inf)),
        ("width must be a whole number of 32 bits, and is 1099511627776",
         lambda: hmesh.Mesh(mesh.positions, mesh.colors, mesh.faces, width=2**40, height=80).render()),
        ("width must be a whole number from 1 to 65536, and is 2.5", lambda: mesh.render(2.5, 3)),
        ("color_bits must be 8 or 16|color_bits must be a whole number", lambda: mesh.tobytes("glb", color_bits="8")),
        ("longer_side must be a number, and is None", lambda: mesh.tobytes("glb", longer_side=None)),
        ("ascii must be True or False, and is None", lambda: mesh.tobytes("ply", ascii=None)),
        ("title must be text, and is None", lambda: mesh.tobytes("html", title=None)),
        ("title must not have a zero", lambda: mesh.tobytes("html", title="a\0b")),
        ("max_vertices must be a whole number", lambda: hmesh.read(mesh.tobytes("hmc"), max_vertices=2**70)),
        ("vertices must be a number that a float holds", lambda: hmesh.mesh_image(image, vertices=10**400)),
        ("percent must be a number that a float holds, and is \\[1\\]", lambda: hmesh.mesh_image(image, percent=[1])),
        ("psnr must be a number that a float holds, and is of type int", lambda: hmesh.mesh_image(image, psnr=-10**5000)),
        ("seed must be a whole number from 0 .* and is of type int", lambda: hmesh.mesh_image(image, seed=10**5000)),
        ("position_step must be a number", lambda: hmesh.mesh_image(image, position_step=10**400)),
        ("channel_weights must be a number", lambda: hmesh.mesh_image(image, channel_weights=[1, 10**400, 1])),
        ("max_error must be a number", lambda: hmesh.mesh_terrain(image[:, :, 0], max_error=10**400)),
        ("weights must not all be 0", lambda: hmesh.mesh_image(image, weights=np.full((80, 120), 1e-300))),  # as floats
        ("channel_weights must be numbers, one after another, and are None", lambda: hmesh.mesh_image(image, channel_weights=None)),
        ("channel_weights must be a number .* and is '1'", lambda: hmesh.mesh_image(image, channel_weights="123")),
        ("percent must be a number that a float holds, and is '5'", lambda: hmesh.mesh_image(image, percent="5")),
        ("vertices must be a number that a float holds, and is b'9'", lambda: hmesh.mesh_image(image, vertices=b"9")),
        (r"format must be one of ply, .* and is \['ply'\]", lambda: mesh.tobytes(["ply"])),
        (r"color_bits must be 8, 16 or 32, and is \[8\]", lambda: mesh.tobytes("hmc", color_bits=[8])),
        ("mesh must be a Mesh, and is of type ndarray", lambda: hmesh.psnr(image, image)),
        ("start must be a Mesh, and is of type dict", lambda: hmesh.mesh_image(image, start={})),
        ("source must be .* and source is of type list", lambda: hmesh.read([1])),
        (r"source must be .* and source.read\(\) is of type str", lambda: hmesh.read(io.StringIO("text"))),
    ):
        with pytest.raises((TypeError, ValueError), match=sentence):
            call()
    with pytest.raises(ValueError, match="truth value"):
        hmesh.mesh_image(image, progress=lambda now: np.array([1, 2]))


def test_a_mesh_takes_no_number_for_another():
    mesh = hmesh.mesh_image(picture(), vertices=50, effort="draft")

    def make(faces=mesh.faces, **sizes):
        return hmesh.Mesh(mesh.positions, mesh.colors, faces, **{"width": 120, "height": 80, **sizes})

    for faces in (mesh.faces.astype(np.int64), mesh.faces.astype(np.float64), mesh.faces.tolist()):
        assert same(make(faces), mesh)
    assert make(np.zeros((0, 3))).faces.shape == (0, 3)
    for wrong in (2**32, -1, 0.5, math.nan, math.inf, 1e30):  # of which 2^32 would be vertex 0, and 0.5 too
        faces = mesh.faces.astype(np.float64)
        faces[3, 1] = wrong
        with pytest.raises(ValueError, match="faces must be whole numbers from 0 to 4294967295"):
            make(faces)
        other = make()
        other.faces = faces
        with pytest.raises(ValueError, match="faces must be whole numbers"):
            other.render()
    with pytest.raises(TypeError, match="faces must be numbers"):
        make(mesh.faces.astype(object))
    for name, words in (("periodic", "none, x, y, xy"), ("samples", "squares, points")):
        other = make()
        setattr(other, name, "z")
        with pytest.raises(ValueError, match=f"{name} must be one of {words}, and is 'z'"):
            other.render()
    for name, value in (("width", 2.5), ("height", math.inf), ("peak", 10**400)):
        with pytest.raises((TypeError, ValueError), match=f"{name} must be a"):
            make(**{name: value})


class Raw(io.RawIOBase):
    """A file without a buffer, which takes a few bytes at a time, and no more than `most`."""

    def __init__(self, most):
        self.got, self.most = bytearray(), most

    def writable(self):
        return True

    def write(self, data):
        part = bytes(data)[:min(1000, self.most - len(self.got))]
        self.got += part
        return len(part) or None


def test_files_that_take_less_than_they_are_given():
    mesh = hmesh.mesh_image(picture(), vertices=100, effort="draft")
    whole, full = Raw(10**9), Raw(2500)
    mesh.write(whole, "ply", ascii=True)
    assert whole.got == mesh.tobytes("ply", ascii=True)
    with pytest.raises(BlockingIOError):
        mesh.write(full, "ply", ascii=True)
    assert full.got == mesh.tobytes("ply", ascii=True)[:2500]
    wrapped = Raw(2500)  # as NamedTemporaryFile(buffering=0) wraps its file
    with pytest.raises(BlockingIOError, match="took 2500 of"):
        mesh.write(tempfile._TemporaryFileWrapper(wrapped, "none", delete=False), "ply", ascii=True)


@pytest.mark.skipif(os.name == "nt", reason="modes of files")
def test_writing_leaves_the_mask_of_new_files_alone(tmp_path, monkeypatch):
    mesh = hmesh.mesh_image(picture(), vertices=50, effort="draft")
    old = os.umask(0o027)
    try:
        with monkeypatch.context() as patch:
            patch.delattr(os, "umask")  # the process's, which another thread may be asking
            mesh.write(tmp_path / "new.ply")
            (tmp_path / "old.ply").write_bytes(b"")
            (tmp_path / "old.ply").chmod(0o604)
            mesh.write(tmp_path / "old.ply")
        assert [(tmp_path / name).stat().st_mode & 0o777 for name in ("new.ply", "old.ply")] == [0o640, 0o604]
    finally:
        os.umask(old)


def test_what_is_no_file_is_refused():
    mesh = hmesh.mesh_image(picture(), vertices=50, effort="draft")
    for target in (3, None, b"mesh.ply", []):
        with pytest.raises(TypeError, match=f"target must be a path .* and is of type {type(target).__name__}"):
            mesh.write(target, "ply")


def test_files_that_give_other_bytes_than_bytes():
    data = hmesh.mesh_image(picture(), vertices=100, effort="draft").tobytes("hmc")
    for kind in (bytes, bytearray, memoryview):
        assert same(hmesh.read(types.SimpleNamespace(read=lambda: kind(data))), hmesh.read(data))


class Trimesh:
    """Stands in for trimesh.Trimesh."""

    def __init__(self, vertices, faces, vertex_colors, process):
        self.vertices, self.faces, self.vertex_colors = vertices, faces, vertex_colors


def test_to_trimesh_agrees_with_the_files(monkeypatch):
    monkeypatch.setitem(sys.modules, "trimesh", types.SimpleNamespace(Trimesh=Trimesh))
    alpha = np.dstack([picture(), np.full((80, 120), 128, np.uint8)])
    alpha[:, :40, 3] = 0
    for image, options in ((picture(), {}), (picture(), {"samples": "points"}), (alpha, {"premultiplied": True})):
        mesh = hmesh.mesh_image(image, vertices=60, **options)
        other = mesh.to_trimesh()
        lines = mesh.tobytes("ply", ascii=True).decode().split("end_header\n")[1].splitlines()[:60]
        rows = np.array([[float(word) for word in line.split()] for line in lines])
        shown = rows[:, 6] > 0 if rows.shape[1] > 6 else np.full(60, True)  # others have no colour to be seen
        assert np.allclose(other.vertices, rows[:, :3]) and 0 < shown.sum()
        assert np.array_equal(other.vertex_colors[shown], rows[shown, 3:])
        assert np.array_equal(other.vertex_colors[:, 3:], rows[:, 6:])


def test_to_trimesh_takes_no_fifth_channel_for_nothing(monkeypatch):
    monkeypatch.setitem(sys.modules, "trimesh", types.SimpleNamespace(Trimesh=Trimesh))
    mesh = hmesh.mesh_image(picture(), vertices=60, effort="draft")
    for channels in (4, 5):
        other = hmesh.Mesh(mesh.positions, np.full((60, channels), 7), mesh.faces, width=120, height=80)
        if channels == 4:
            assert (other.to_trimesh().vertex_colors == 7).all()
            continue
        with pytest.raises(ValueError, match="1 to 4 channels, and the mesh has 5"):  # of which the fourth would be alpha
            other.to_trimesh()


def test_to_trimesh():
    trimesh = pytest.importorskip("trimesh")
    mesh = hmesh.mesh_image(picture(), vertices=100)
    other = mesh.to_trimesh()
    assert isinstance(other, trimesh.Trimesh)
    assert len(other.vertices) == 100 and other.area == pytest.approx(120 * 80)
    assert (other.face_normals[:, 2] > 0).all()
