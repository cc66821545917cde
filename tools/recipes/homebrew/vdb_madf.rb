# SPDX-FileCopyrightText: The vdb_madf authors
# SPDX-License-Identifier: Apache-2.0
#
# A formula for Homebrew on Linux. What OWNER and the zeros stand for is known once there is a release:
# tools/manual/packages.md.
class VdbMadf < Formula
  desc "Separates the grains of granular microstructures in micro-CT volumes"
  homepage "https://OWNER.invalid/"
  url "https://OWNER.invalid/vdb_madf-0.1.0.tar.gz"
  sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  license "Apache-2.0"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "eigen" => :build
  depends_on "nlohmann-json" => :build
  depends_on "boost"
  depends_on "c-blosc"
  depends_on "cairo"
  depends_on "fmt"
  depends_on "freetype"
  depends_on "hdf5"
  depends_on "libpng"
  depends_on "libtiff"
  depends_on :linux
  depends_on "openvdb"
  depends_on "qhull"
  depends_on "tbb"
  depends_on "zlib"
  depends_on "zstd"

  resource "open-sans" do
    url "https://OWNER.invalid/OpenSans-Regular.ttf"
    sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  end

  def install
    resource("open-sans").stage buildpath/"font"
    args = %W[
      -DVDB_MADF_BUILD_TESTS=OFF
      -DVDB_MADF_MPI=OFF
      -DVDB_MADF_FONT=#{buildpath}/font/OpenSans-Regular.ttf
    ]
    system "cmake", "-S", ".", "-B", "build", *args, *std_cmake_args
    system "cmake", "--build", "build", "--target", "vdb_madf_product"
    system "cmake", "--install", "build"
  end

  test do
    assert_match version.to_s, shell_output("#{bin}/vdb_madf --version")
    system bin/"vdb_madf", "generate", "sintered", "sample.vdb", "--size", "32", "--count", "3"
    system bin/"vdb_madf", "segment", "sample.vdb", "grains.vdb"
  end
end
