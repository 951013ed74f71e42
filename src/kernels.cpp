#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "simulate.hpp"

/// A module that holds the loops over time, compiled for one instruction set, and hands out where they are.
namespace {

using namespace strainwave::host;

const Kernels kernels{&evaluate,
                      &lay_out,
                      &rest,
                      &started,
                      &consistent,
                      &begin,
                      &schedule,
                      &aged,
                      &advance_hysteresis,
                      &break_away,
                      &step_once,
                      &natural_frequency,
                      &max_rate,
                      &bristle_frequency,
                      &observe,
                      &measure,
                      &simulate,
                      &simulate_adaptively,
                      &simulate_many,
                      &differentiate,
                      &differentiate_rates,
                      &differentiate_loop,
                      &differentiate_steady};

PyModuleDef definition{PyModuleDef_HEAD_INIT, SW_MODULE, nullptr, -1, nullptr, nullptr, nullptr, nullptr, nullptr};

}  // namespace

extern "C" __attribute__((visibility("default"))) PyObject* SW_INITIALISE() {
    PyObject* module = PyModule_Create(&definition);
    if (!module) return nullptr;
    PyObject* capsule = PyCapsule_New(const_cast<Kernels*>(&kernels), "strainwave." SW_MODULE ".kernels", nullptr);
    if (!capsule || PyModule_AddObject(module, "kernels", capsule) < 0) {
        Py_XDECREF(capsule);
        Py_DECREF(module);
        return nullptr;
    }
    return module;
}
