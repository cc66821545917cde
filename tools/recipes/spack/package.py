# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
"""A package for Spack. What OWNER and the zeros stand for is known once there is a release:
tools/manual/packages.md."""

from spack.package import *
from spack_repo.builtin.build_systems.cmake import CMakePackage


class VdbMadf(CMakePackage):
    """Separates the grains of granular microstructures in micro-CT volumes."""

    homepage = "https://OWNER.invalid/"
    url = "https://OWNER.invalid/vdb_madf-0.1.0.tar.gz"

    maintainers("OWNER")

    license("Apache-2.0")

    version("0.1.0", sha256="0000000000000000000000000000000000000000000000000000000000000000")

    variant("hdf5", default=True, description="Read and write HDF5")
    variant("mpi", default=False, description="Build vdb_madf_mpi, for many nodes")

    resource(
        name="open-sans",
        url="https://OWNER.invalid/OpenSans-Regular.ttf",
        sha256="0000000000000000000000000000000000000000000000000000000000000000",
        expand=False,
        placement="font",
    )

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("cli11", type="build")
    depends_on("boost+iostreams")
    depends_on("c-blosc")
    depends_on("cairo+ft")
    depends_on("eigen@3.3:")
    depends_on("fmt")
    depends_on("freetype")
    depends_on("hdf5~mpi", when="+hdf5")
    depends_on("libpng")
    depends_on("libtiff")
    depends_on("mpi", when="+mpi")
    depends_on("nlohmann-json")
    depends_on("openvdb@10:")
    depends_on("qhull@2020.1:")
    depends_on("tbb")
    depends_on("zlib-api")
    depends_on("zstd")

    requires("platform=linux")

    def cmake_args(self):
        font = join_path(self.stage.source_path, "font", "OpenSans-Regular.ttf")
        return [
            self.define("VDB_MADF_BUILD_TESTS", False),
            self.define("VDB_MADF_FONT", font),
            self.define_from_variant("VDB_MADF_HDF5", "hdf5"),
            self.define_from_variant("VDB_MADF_MPI", "mpi"),
        ]
