// SPDX-License-Identifier: BSD-3-Clause
// Files that hold what does not have to be in memory: pieces that wait for their cell, and finished surfaces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace conceg::mesh {

// A file that is written and read at places. Without a name it goes with the process. Errors are E_IO with
// the name and the system's reason.
class SideFile {
public:
  // A file without a name in `folder`.
  explicit SideFile(const std::string &folder);
  // The file `path`, which stays; made when it is not there. Refused while another process has it.
  static SideFile named(const std::string &path);
  ~SideFile();
  SideFile(SideFile &&other) noexcept;
  SideFile &operator=(SideFile &&) = delete;

  void write(std::uint64_t at, const void *bytes, std::size_t count) const;
  void read(std::uint64_t at, void *bytes, std::size_t count) const;
  std::uint64_t size() const;
  void cut(std::uint64_t bytes) const;
  const std::string &name() const { return name_; }
  int descriptor() const { return fd_; }

private:
  SideFile(int fd, std::string name) : fd_(fd), name_(std::move(name)) {}
  [[noreturn]] void fail_io(const char *what) const;
  int fd_ = -1;
  std::string name_;
};

// A file's first bytes in memory, read only.
class Mapping {
public:
  Mapping() = default;
  Mapping(const SideFile &file, std::uint64_t bytes);
  ~Mapping() { clear(); }
  Mapping(const Mapping &) = delete;
  Mapping &operator=(const Mapping &) = delete;
  void swap(Mapping &other) noexcept;
  const std::byte *data() const { return data_; }
  // Pages that have been looked at may go; they come back from the file when they are asked for.
  void forget() const;

private:
  void clear();
  const std::byte *data_ = nullptr;
  std::size_t bytes_ = 0;
};

// E_IO when `folder` has less than `bytes` left; `what` says what needs them.
void need_free_space(const std::string &folder, double bytes, const char *what);

} // namespace conceg::mesh
