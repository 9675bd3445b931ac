// SPDX-License-Identifier: BSD-3-Clause
// The golden figures of real cells, made with NeuroM and TMD (CONCEG_SHARED/goldens/morphology).
#pragma once

#include "check.h"

#include "conceg/swc.h"

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace golden {

// Enough of JSON for the golden file.
struct Json {
  double number = 0.0;
  std::string text;
  std::vector<Json> items;
  std::map<std::string, Json> members;
  const Json &at(const char *key) const { return members.at(key); }
};

class Parser {
public:
  explicit Parser(const std::string &text) : p_(text.c_str()) {}
  Json value() {
    Json out;
    space();
    if (*p_ == '{' || *p_ == '[') {
      const bool object = *p_++ == '{';
      for (space(); *p_ && *p_ != '}' && *p_ != ']'; space()) {
        if (*p_ == ',') {
          p_++;
          continue;
        }
        if (object) {
          const std::string key = string();
          space(), p_++;
          out.members[key] = value();
        } else
          out.items.push_back(value());
      }
      p_++;
    } else if (*p_ == '"')
      out.text = string();
    else {
      char *stop;
      out.number = std::strtod(p_, &stop);
      if (stop == p_) stop++; // true, false, null: letter by letter
      p_ = stop;
      while (*p_ >= 'a' && *p_ <= 'z')
        p_++;
    }
    return out;
  }

private:
  void space() {
    while (*p_ == ' ' || *p_ == '\n' || *p_ == '\t' || *p_ == '\r')
      p_++;
  }
  std::string string() {
    std::string out;
    for (p_++; *p_ && *p_ != '"'; p_++) {
      if (*p_ == '\\') p_++;
      out += *p_;
    }
    p_++;
    return out;
  }
  const char *p_;
};

inline std::string folder() {
  return std::string(check_shared()) + "/goldens/morphology/";
}

// The whole file; ends the program as skipped where it is absent.
inline Json load() {
  if (check_failed_) exit(check_done()); // what failed before is not to be called skipped
  if (!check_shared()) SKIP("CONCEG_SHARED is not set: no golden figures");
  std::ifstream in(folder() + "goldens.json");
  if (!in) SKIP("no goldens/morphology/goldens.json in CONCEG_SHARED");
  std::ostringstream text;
  text << in.rdbuf();
  const std::string json = text.str();
  return Parser(json).value();
}

} // namespace golden
