// The kernels of an actuator on a GPU.
#pragma once
#include "actuator.hpp"

extern "C" __global__ void strainwave_words(int count, int* found) {
    if (blockIdx.x * blockDim.x + threadIdx.x == 0) actuator::measure(found);
}

extern "C" __global__ void strainwave_prepare(int count, const actuator::S* numbers, double* prepared, int* problems) {
    const int i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count) actuator::prepare(i, numbers, prepared, problems);
}

extern "C" __global__ void strainwave_advance(int count, const double* prepared, int prepared_count, const actuator::S* before,
                                              actuator::S* after, const float* position, const float* speed,
                                              const float* target_position, const float* target_speed, const float* feedforward,
                                              const unsigned* position_place, const unsigned* speed_place,
                                              const unsigned* target_position_place, const unsigned* target_speed_place, double dt,
                                              double max_step, float* torque, float* outputs) {
    const int i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i < count)
        actuator::advance(i, count, prepared, prepared_count, before, after, position, speed, target_position, target_speed,
                          feedforward, position_place, speed_place, target_position_place, target_speed_place, dt, max_step, torque,
                          outputs);
}
