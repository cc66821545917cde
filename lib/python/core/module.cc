// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "bindings.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/base/size_text.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/files/verified_files.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/segmentation/initialize.h"

namespace vdb_madf::python {

namespace {

/// How the user of the module does what an error of the library hints at.
const char* argumentFor(Hint hint) {
  switch (hint) {
    case Hint::none:
    case Hint::areLabels:
      break;
    case Hint::rawLayout:
      return " (numpy.memmap)";
    case Hint::dataset:
      return " (dataset=)";
    case Hint::voxelSize:
      return " (voxel_size=)";
    case Hint::memoryLimit:
      return " (max_memory=)";
    case Hint::manifolds:
      return " (keep=)";
    case Hint::smallerLabels:
      return " (Labels.reduce)";
    case Hint::unverified:
      return " (verify_files(False))";
  }
  return "";
}

py::handle newException(py::module_& m, const char* name, const py::object& bases,
                        const char* doc) {
  const std::string fullName = std::string("vdb_madf.") + name;
  const py::handle type = PyErr_NewExceptionWithDoc(fullName.c_str(), doc, bases.ptr(), nullptr);
  if (!type) throw py::error_already_set();
  m.add_object(name, type);
  return type;  // as old as the process
}

void bindErrors(py::module_& m) {
  const auto builtin = [](PyObject* type) { return py::reinterpret_borrow<py::object>(type); };
  static const py::handle invalidInput =
      newException(m, "InvalidInput", builtin(PyExc_ValueError),
                   "The data or options cannot be worked with; the text says why and what to do.");
  static const py::handle ioError =
      newException(m, "IoError", builtin(PyExc_OSError),
                   "A file cannot be read or written; the text names the file.");
  static const py::handle notEnoughMemory = newException(
      m, "NotEnoughMemory", py::make_tuple(invalidInput, builtin(PyExc_MemoryError)),
      "The work would need more memory than max_memory allows or the machine has free.");
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const SelectionNeeded& e) {
      const std::string text =
          std::string(e.what()) +
          (e.orCylinder() ? " (roi='cylinder', or threshold=)" : " (threshold=, phase= or range=)");
      PyErr_SetString(invalidInput.ptr(), text.c_str());
    } catch (const InvalidInput& e) {
      const bool memory = e.hint() == Hint::memoryLimit;
      const std::string text = std::string(e.what()) + argumentFor(e.hint());
      PyErr_SetString((memory ? notEnoughMemory : invalidInput).ptr(), text.c_str());
    } catch (const IoError& e) {
      const std::string text = std::string(e.what()) + argumentFor(e.hint());
      PyErr_SetString(ioError.ptr(), text.c_str());
    }
  });
}

}  // namespace

}  // namespace vdb_madf::python

PYBIND11_MODULE(_core, m) {
  using namespace vdb_madf::python;
  vdb_madf::initialize();
  m.doc() = "The library behind vdb_madf; the package wraps it.";
  m.attr("__version__") = vdb_madf::kVersion;
  bindErrors(m);
  py::class_<Call>(m, "Call", "Who hears of the progress of a call, and its number of threads.")
      .def(py::init([](const py::object& progress, int threads) {
             return Call{progress, threads};
           }),
           py::arg("progress") = py::none(), py::arg("threads") = 0)
      .def_readonly("progress", &Call::progress);
  m.def("voxel_size_from_text", [](const std::string& text) {
    return triple(reversed(vdb_madf::voxelSizeFromText(text).edges()));
  });
  m.def("bytes_from_text", &vdb_madf::bytesFromText);
  m.def("verify_files", &vdb_madf::setFilesAreVerified, py::arg("verified"),
        "Whether files of ours are compared with their digest when they are read, in this process: "
        "so at first.");
  m.def("reads_hdf5", &vdb_madf::readsHdf5);
  m.def("written_endings", &vdb_madf::writtenEndings);
  bindGrids(m);
  bindVolumes(m);
  bindMethod(m);
  bindMeasures(m);
  bindLabels(m);
  bindTracks(m);
  bindFiles(m);
  bindSamples(m);
}
