// SPDX-License-Identifier: BSD-3-Clause
#include "checkpoint.hpp"

#include "settings.hpp"

#include "conceg/run.h"

#include <cerrno>
#include <memory>
#include <unistd.h>

namespace conceg::simulate {

namespace {

using Document = std::unique_ptr<conceg_doc, conceg_status (*)(conceg_doc *)>;

// An array of our own group: its unit is stated here, as no schema does.
template <class T> void keep(conceg_doc *doc, const char *path, const T *data, std::size_t count) {
  conceg_array array = {};
  array.size = sizeof array;
  array.dtype = dtype_of<T>::value, array.rank = 1, array.shape[0] = count;
  array.data = data, array.unit = "";
  must(conceg_doc_write(doc, path, &array));
}
template <class T>
std::vector<T> kept(conceg_doc *doc, const std::string &file, const char *path, std::size_t count) {
  const View<T> v = view<T>(doc, path);
  if (v.rows() != count)
    fail(CONCEG_E_FORMAT, "%s: %s: expected %zu values, got %zu", file.c_str(), path, count, v.rows());
  return std::vector<T>(v.begin(), v.end());
}
const double *flat(const std::vector<glm::dvec3> &v) {
  return v.empty() ? nullptr : &v[0].x;
}
std::vector<glm::dvec3> triples(const std::vector<double> &v) {
  std::vector<glm::dvec3> out(v.size() / 3);
  for (std::size_t i = 0; i < out.size(); i++)
    out[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  return out;
}

} // namespace

Checkpoint::Checkpoint(conceg_ctx *ctx, conceg_doc *doc, const conceg_params *params, const std::string &path)
    : ctx_(ctx), path_(path) {
  if (path.empty()) return;
  char digest[65];
  for (const char *group : {"/domain", "/cells", "/meshes", "/protocol"}) {
    must(conceg_doc_digest(doc, group, digest));
    key_ += std::string(group) + " " + digest + "\n";
  }
  key_ +=
      std::string(conceg_params_canonical(params)) + "\nseed " + std::to_string(conceg_ctx_seed(ctx)) + "\n";
  walkers_ = static_cast<std::uint64_t>(conceg_params_i64(params, "walkers"));
  shapes_ = view<double>(doc, "/protocol/shape", view<double>(doc, "/protocol/interval_end").rows()).rows();
  records_ = displacement_times(conceg_params_text(params, "times_ms")).size();
}

bool Checkpoint::read(Walked &walked) const {
  if (access(path_.c_str(), F_OK) != 0 && errno == ENOENT) return false;
  conceg_doc *opened = nullptr;
  must(conceg_doc_open(ctx_, path_.c_str(), &opened));
  const Document document(opened, conceg_doc_close);
  if (!has(opened, "/x_simulate/key"))
    fail(CONCEG_E_FORMAT, "%s: expected a checkpoint of simulate, got another document", path_.c_str());
  const char *key = nullptr;
  must(conceg_doc_read_text(opened, "/x_simulate/key", &key));
  if (key_ != key)
    fail(CONCEG_E_PARAM,
         "checkpoint: %s is of another run (other surfaces, protocol, parameters or seed); give another "
         "file, or remove it",
         path_.c_str());
  const std::size_t blocks = (walkers_ + Walked::block - 1) / Walked::block;
  walked.done = kept<std::uint8_t>(opened, path_, "/x_simulate/done", blocks);
  walked.place = triples(kept<double>(opened, path_, "/x_simulate/place", 3 * walkers_));
  walked.inside = kept<std::uint8_t>(opened, path_, "/x_simulate/inside", walkers_);
  walked.walkers.count = walkers_;
  walked.walkers.vector = triples(kept<double>(opened, path_, "/x_simulate/vector", 3 * walkers_ * shapes_));
  walked.walkers.displacement =
      triples(kept<double>(opened, path_, "/x_simulate/displacement", 3 * walkers_ * records_));
  if (has(opened, "/x_simulate/weight"))
    walked.walkers.weight = kept<double>(opened, path_, "/x_simulate/weight", walkers_);
  const std::vector<std::uint64_t> t = kept<std::uint64_t>(opened, path_, "/x_simulate/tally", 7 * blocks);
  for (std::size_t b = 0; b < blocks; b++) {
    const std::uint64_t *of = &t[7 * b];
    walked.tally.push_back({of[0], of[1], of[2], of[3], of[4], of[5], of[6]});
  }
  return true;
}

void Checkpoint::write(const Walked &walked) const {
  conceg_doc *made = nullptr;
  must(conceg_doc_new(ctx_, &made));
  const Document document(made, conceg_doc_close);
  must(conceg_doc_write_text(made, "/x_simulate/key", key_.c_str()));
  const Walkers &w = walked.walkers;
  keep(made, "/x_simulate/done", walked.done.data(), walked.done.size());
  keep(made, "/x_simulate/place", flat(walked.place), 3 * walked.place.size());
  keep(made, "/x_simulate/inside", walked.inside.data(), walked.inside.size());
  keep(made, "/x_simulate/vector", flat(w.vector), 3 * w.vector.size());
  keep(made, "/x_simulate/displacement", flat(w.displacement), 3 * w.displacement.size());
  if (!w.weight.empty()) keep(made, "/x_simulate/weight", w.weight.data(), w.weight.size());
  std::vector<std::uint64_t> tally;
  for (const Tally &t : walked.tally)
    tally.insert(tally.end(), {t.steps, t.moves, t.jumps, t.casts, t.reflections, t.passages, t.retractions});
  keep(made, "/x_simulate/tally", tally.data(), tally.size());
  must(conceg_doc_save(made, path_.c_str()));
}

} // namespace conceg::simulate
