// SPDX-License-Identifier: BSD-3-Clause
// Exact signals of closed pores: pairs of pulses (delta 5 ms, Delta 20 ms) by the matrix method (multiple
// correlation functions, Grebenkov 2007) in the Neumann eigenbasis, at these b (ms/um^2).
#pragma once

namespace conceg::simulate::testing {

inline constexpr double golden_b[9] = {0.5, 1, 2, 3, 5, 8, 10, 12, 15};

enum class Pore { sphere, cylinder, planes };
struct Golden {
  const char *name;
  Pore pore;
  double size, diffusivity; // radius, or distance of the planes, um; um^2/ms
  double signal[9];
};
inline constexpr Golden goldens[] = {
    {"sphere 2",
     Pore::sphere,
     2,
     2,
     {0.99638452, 0.99278141, 0.98561218, 0.97849198, 0.96439740, 0.94361541, 0.92999704, 0.91656483,
      0.89676032}},
    {"sphere 5",
     Pore::sphere,
     5,
     2,
     {0.92107509, 0.84752295, 0.71528290, 0.60093273, 0.41769688, 0.23106442, 0.14964447, 0.09290352,
      0.04059998}},
    {"sphere 7",
     Pore::sphere,
     7,
     2,
     {0.82185833, 0.67152741, 0.43960064, 0.27908709, 0.09969699, 0.01414930, 0.00546397, 0.00770362,
      0.01258087}},
    {"sphere 10",
     Pore::sphere,
     10,
     2,
     {0.68302488, 0.46039461, 0.20166110, 0.08631275, 0.02265525, 0.01282599, 0.00845188, 0.00499315,
      0.00313742}},
    {"sphere 5, D 3",
     Pore::sphere,
     5,
     3,
     {0.93497909, 0.87365200, 0.76134824, 0.66170733, 0.49548698, 0.31308836, 0.22598882, 0.15998967,
      0.09106880}},
    {"sphere 7, D 3",
     Pore::sphere,
     7,
     3,
     {0.83595425, 0.69528467, 0.47279579, 0.31296397, 0.12292812, 0.01830204, 0.00235831, 0.00195099,
      0.00824295}},
    {"cylinder 0.5",
     Pore::cylinder,
     0.5,
     2,
     {0.99997533, 0.99995065, 0.99990131, 0.99985196, 0.99975328, 0.99960528, 0.99950662, 0.99940798,
      0.99926003}},
    {"cylinder 2",
     Pore::cylinder,
     2,
     2,
     {0.99440074, 0.98883047, 0.97777631, 0.96683641, 0.94529504, 0.91381286, 0.89336568, 0.87334156,
      0.84408092}},
    {"cylinder 5",
     Pore::cylinder,
     5,
     2,
     {0.89324238, 0.79604356, 0.62749212, 0.48913452, 0.28539561, 0.11030252, 0.05028056, 0.01844802,
      0.00211705}},
    {"planes 4",
     Pore::planes,
     4,
     2,
     {0.99028570, 0.98065503, 0.96164201, 0.94295584, 0.90654413, 0.85425497, 0.82089250, 0.78868474,
      0.74246053}},
    {"planes 10",
     Pore::planes,
     10,
     2,
     {0.84869719, 0.71609012, 0.49971921, 0.33785194, 0.13569994, 0.02157142, 0.01081544, 0.02236608,
      0.05099348}},
};

// In the Gaussian phase approximation, sphere of 7 um, at b = 1, 3, 5, 10, 15: what the signal is not.
inline constexpr double approximate_b[5] = {1, 3, 5, 10, 15};
inline constexpr double approximate_sphere_7[5] = {0.67918062, 0.31329672, 0.14451949, 0.02088588,
                                                   0.00301842};

} // namespace conceg::simulate::testing
