"""hmesh for Conan 2: headers only, one package for all settings. The sources are those of the checkout that holds it."""
import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.files import copy, load
from conan.tools.layout import basic_layout


class HmeshConan(ConanFile):
    name = "hmesh"
    description = "Turns a raster image into a triangle mesh with one colour per vertex"
    license = "MIT"
    topics = ("image", "mesh", "vector-graphics", "header-only")
    package_type = "header-library"
    settings = "os", "arch", "compiler", "build_type"
    no_copy_source = True

    def _checkout(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        header = load(self, os.path.join(self._checkout(), "include", "hmesh", "core", "version.hpp"))
        self.version = re.search(r'#define HMESH_VERSION_STRING "(.*)"', header).group(1)

    def export_sources(self):
        for pattern in ("include/hmesh/*.hpp", "include/hmesh/*.ipp", "cmake/hmesh-meshes.cmake", "LICENSE"):
            copy(self, pattern, self._checkout(), self.export_sources_folder)

    def layout(self):
        basic_layout(self, src_folder=".")

    def requirements(self):
        self.requires("eigen/[>=3.4.0]", transitive_headers=True)

    def package_id(self):
        self.info.clear()

    def validate(self):
        check_min_cppstd(self, 17)

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        for pattern in ("*.hpp", "*.ipp"):
            copy(self, pattern, os.path.join(self.source_folder, "include"), os.path.join(self.package_folder, "include"))
        copy(self, "*.cmake", os.path.join(self.source_folder, "cmake"), os.path.join(self.package_folder, "share", "cmake", "hmesh"))

    def package_info(self):
        self.cpp_info.bindirs = []
        self.cpp_info.libdirs = []
        self.cpp_info.set_property("cmake_file_name", "hmesh")
        self.cpp_info.set_property("cmake_target_name", "hmesh::hmesh")
        self.cpp_info.set_property("pkg_config_name", "hmesh")
        self.cpp_info.set_property("cmake_build_modules", [os.path.join("share", "cmake", "hmesh", "hmesh-meshes.cmake")])
