// SPDX-License-Identifier: BSD-3-Clause
// fastpli's fibre bundles as text: rows "x y z r" in um; an empty line ends a fibre, two end a bundle. A
// bundle becomes a type.
#include "scene.hpp"

#include "h5_bundles.hpp"

namespace conceg::importing {

void parse_fastpli(TextFile text, Scene &scene) {
  SceneCell fibre;
  std::size_t bundle = 0, empty = 0;
  const auto end_fibre = [&] {
    if (fibre.position.empty()) return;
    if (fibre.position.size() < 2) text.refuse("a fibre of one point: expected at least two");
    fibre.type = "bundle " + std::to_string(bundle), fibre.soma = fibre.position[0];
    scene.cells.push_back(std::move(fibre));
    fibre = SceneCell();
  };
  std::string_view line;
  while (text.line(line)) {
    const auto words = words_of(line);
    if (words.empty()) {
      end_fibre();
      if (++empty == 2 && !scene.cells.empty()) bundle++;
      continue;
    }
    empty = 0;
    if (words.size() != 4) text.refuse("expected x y z r, got %zu values", words.size());
    fibre.follow(
        {text.coordinate(words[0], "x"), text.coordinate(words[1], "y"), text.coordinate(words[2], "z")},
        text.radius(words[3], "r"), CONCEG_SWC_AXON);
  }
  end_fibre();
  if (scene.cells.empty()) text.refuse("expected rows x y z r, got none");
}

Scene read_fastpli(const Request &request) {
  const std::string &path = only_file(request, ".dat or .h5");
  Scene scene;
  if (path.size() < 3 || path.compare(path.size() - 3, 3, ".h5") != 0) {
    parse_fastpli(TextFile::open(request.ctx, path), scene);
    return scene;
  }
  for (const BundleFibre &rows : read_h5_bundles(path, conceg_ctx_memory(request.ctx))) {
    SceneCell fibre;
    for (std::size_t i = 0; i < rows.row.size() / 4; i++) {
      const double *row = &rows.row[4 * i];
      for (int k = 0; k < 4; k++)
        if (!(std::abs(row[k]) <= coordinate_limit_um) || (k == 3 && !(static_cast<float>(row[3]) > 0.0f)))
          fail(CONCEG_E_FORMAT, "%s: /%s/%s[%zu]: expected x y z r in um with r above 0, got %g %g %g %g",
               path.c_str(), rows.bundle.c_str(), rows.fibre.c_str(), i, row[0], row[1], row[2], row[3]);
      fibre.follow({row[0], row[1], row[2]}, row[3], CONCEG_SWC_AXON);
    }
    fibre.type = "bundle " + rows.bundle, fibre.soma = fibre.position[0];
    scene.cells.push_back(std::move(fibre));
  }
  return scene;
}

} // namespace conceg::importing
