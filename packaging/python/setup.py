"""Builds hmesh._core, of which each number of channels is compiled in a file of its own.

HMESH_PYTHON_CHANNELS: the most channels that images may have, 1 to 16; fewer take less time to compile
HMESH_PYTHON_FLAGS: further flags of the compiler
HMESH_JOBS: how many compilers may run at once; by default as many as there are cores
"""

import os
import re
import shutil
from pathlib import Path

from pybind11.setup_helpers import ParallelCompile, Pybind11Extension, build_ext
from setuptools import setup
from setuptools.command.sdist import sdist

here = Path(__file__).resolve().parent
os.chdir(here)
repository = here.parents[1]
# A source distribution has the library's headers beside this file.
packed = here / "headers"
headers = packed if packed.is_dir() else repository / "include"
pool = packed if packed.is_dir() else repository / "examples"

text = (headers / "hmesh/core/version.hpp").read_text()
version = re.search(r'HMESH_VERSION_STRING "([^"]+)"', text).group(1)
channels = int(os.environ.get("HMESH_PYTHON_CHANNELS", "16"))
if not 1 <= channels <= 16:
    raise SystemExit(f"HMESH_PYTHON_CHANNELS must be 1 to 16, and is {channels}")


def sources():
    written = Path("build/sources")
    written.mkdir(parents=True, exist_ok=True)
    files = ["source/module.cpp", "source/heights.cpp"]
    for count in range(channels, 0, -1):  # what takes longest comes first
        file = written / f"meshing_{count}.cpp"
        content = f"#define HMESH_PYTHON_CHANNELS {count}\n#include \"meshing.inl\"\n"
        if not file.exists() or file.read_text() != content:
            file.write_text(content)
        files.append(str(file))
    return files


class SourceDistribution(sdist):
    """With the headers that the module is made of."""

    def make_release_tree(self, base_dir, files):
        super().make_release_tree(base_dir, files)
        to = Path(base_dir) / "headers"
        if not to.exists():
            shutil.copytree(headers / "hmesh", to / "hmesh")
            shutil.copy(pool / "thread_pool.hpp", to)


is_msvc = os.name == "nt"
flags = ["/O2", "/bigobj"] if is_msvc else ["-O3", "-g0", "-fvisibility=hidden", "-ffp-contract=off", "-pthread"]
extension = Pybind11Extension(
    "hmesh._core",
    sources(),
    include_dirs=["source", str(headers), str(pool)],
    define_macros=[("HMESH_PYTHON_MAX_CHANNELS", str(channels)), ("NDEBUG", "1")],
    extra_compile_args=flags + os.environ.get("HMESH_PYTHON_FLAGS", "").split(),
    extra_link_args=[] if is_msvc else ["-pthread"],
    cxx_std=17,
)
ParallelCompile("HMESH_JOBS", default=0).install()
setup(version=version, ext_modules=[extension], cmdclass={"build_ext": build_ext, "sdist": SourceDistribution})
