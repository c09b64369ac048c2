// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include <Python.h>

#include <string>
#include <vector>

#include "app/program.hpp"

namespace {

/// The words of the command line; empty after an error of Python's.
std::vector<std::string> words_of(PyObject* list) {
  std::vector<std::string> words;
  const Py_ssize_t count = PyList_Size(list);
  for (Py_ssize_t i = 0; i < count; ++i) {
    PyObject* bytes = PyUnicode_EncodeFSDefault(PyList_GetItem(list, i));
    if (bytes == nullptr) return {};
    words.emplace_back(PyBytes_AsString(bytes));
    Py_DecRef(bytes);
  }
  return words;
}

PyObject* run(PyObject*, PyObject* list) {
  const std::vector<std::string> words = words_of(list);
  if (PyErr_Occurred() != nullptr) return nullptr;
  std::vector<const char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(word.c_str());
  arguments.push_back(nullptr);
  PyThreadState* thread = PyEval_SaveThread();
  const int code = posemix::run_program(static_cast<int>(words.size()), arguments.data());
  PyEval_RestoreThread(thread);
  return PyLong_FromLong(code);
}

PyMethodDef functions[] = {
    {"run", run, METH_O, "Runs the program with a command line, sys.argv; returns its exit code."},
    {nullptr, nullptr, 0, nullptr}};

PyModuleDef program = {PyModuleDef_HEAD_INIT,
                       "_program",
                       "The program, in the library of the package.",
                       -1,
                       functions,
                       nullptr,
                       nullptr,
                       nullptr,
                       nullptr};

}  // namespace

/// A second module in the library of the package: `posemix` on the command line, which needs
/// neither NumPy nor the rest of the package.
PyMODINIT_FUNC PyInit__program() { return PyModule_Create(&program); }
