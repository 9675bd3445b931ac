// SPDX-License-Identifier: BSD-3-Clause
// Integrity gates: what a document must satisfy before any figure drawn from it is believed. Each gate looks
// at the document as it stands, through the public interface, and gives one line.
#pragma once

#include "parallel.hpp"

#include "conceg/doc.h"
#include "formatted.hpp"

#include <string>
#include <vector>

namespace conceg::gates {

enum class Verdict { passed, failed, void_ }; // void: the document lacks what the gate would look at

struct Gate {
  std::string group, name;
  Verdict verdict = Verdict::void_;
  double value = 0; // 0 when void
  std::string unit; // of value; "" = a count
  std::string rule; // "at most 0.005"
  std::string note; // what was looked at, and the first place that fails; or why the gate is void
};
const char *verdict_name(Verdict verdict);

class Gates {
public:
  // Passes when value <= limit (so NaN fails); an infinite value stands as 1e300.
  void at_most(const char *group, const char *name, double value, double limit, const char *unit,
               const std::string &note);
  void at_least(const char *group, const char *name, double value, double limit, const char *unit,
                const std::string &note);
  // Passes when nothing was found; `first` names the first find.
  void none(const char *group, const char *name, std::uint64_t found, const std::string &looked_at,
            const std::string &first);
  void not_judged(const char *group, const char *name, const std::string &why);

  const std::vector<Gate> &all() const { return gates_; }
  std::size_t count(Verdict verdict) const;

private:
  void add(const char *group, const char *name, bool good, double value, const char *unit, std::string rule,
           const std::string &note);
  std::vector<Gate> gates_;
};

struct Limits {
  double icvf = 0.005;                   // difference of two measures of the volume fraction
  double cell_volume = 0.05;             // of a cell's labels from its mesh, relative
  double cable = 0.8;                    // least share of the cable asked for
  double detached = 0.01;                // largest share of the cells' volume that the meshes leave out
  double least_gap_um = 0;               // 0: half of /meshes@gap
  std::uint64_t points = 1000000;        // located at random
  bool space = true;                     // look for the pieces of the extracellular space
  std::size_t check_memory = 512u << 20; // bytes that the test of pairs may take
};

// In this order; each adds its gates, void ones too, and throws only when the run is cancelled or memory
// ends.
void format_gates(conceg_doc *doc, Gates &gates);
void cell_gates(conceg_doc *doc, Gates &gates);
void skeleton_gates(conceg_doc *doc, Gates &gates);
void bar_gates(conceg_doc *doc, const Limits &limits, Gates &gates);
void surface_gates(conceg_doc *doc, const Limits &limits, Workers &workers, const Progress &progress,
                   Gates &gates);
void label_gates(conceg_doc *doc, Workers &workers, Gates &gates);
void volume_gates(conceg_ctx *ctx, conceg_doc *doc, const Limits &limits, Workers &workers, Gates &gates);
void space_gates(conceg_doc *doc, const Limits &limits, Workers &workers, const Progress &progress,
                 Gates &gates);
void walk_gates(conceg_doc *doc, Gates &gates);

} // namespace conceg::gates
