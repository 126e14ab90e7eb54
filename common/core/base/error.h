// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace lapedit {

/// Why an edit was refused; every cause is reached by a test.
enum class ErrorCause {
  EmptyMesh,            ///< no vertices or no faces
  NoHandle,             ///< no handle group, or a group without vertices
  HandleOutsideRegion,  ///< a handle vertex is not in the given region
  EmptyRegion,          ///< the region has no vertices
  NothingToFollow,      ///< the region is the handle alone
  BadParameter,         ///< a number or name outside its range
  NotFinite,            ///< NaN or infinite coordinate or target
  BadIndex,             ///< a vertex number outside the mesh, or in two groups
  IllConditioned,       ///< the system cannot be solved to a useful accuracy
  MeshMismatch,         ///< the edit was recorded on another mesh
  BadScript,            ///< text that is not a valid edit
  Cancelled             ///< the progress callback answered "stop"
};

/// The one exception of the core. what() is a message for the user: what is wrong, where, and what to do.
class EditError : public std::runtime_error {
 public:
  /// @param sentence  the message for the user
  /// @param vertex    number of the mesh vertex that the message is about; -1: none
  EditError(ErrorCause cause, const std::string& sentence, int vertex = -1)
      : std::runtime_error(sentence), cause_(cause), vertex_(vertex) {}
  ErrorCause cause() const { return cause_; }
  int vertex() const { return vertex_; }
  /// Returns the key of the edit that the message is about, such as "steps[0].region.radius"; empty: none.
  const std::string& key() const { return key_; }
  /// Sets the key, or puts a key before the one that is set.
  EditError& at(const std::string& key) {
    key_ = key_.empty() ? key : key + "." + key_;
    return *this;
  }

 private:
  ErrorCause cause_;
  int vertex_;
  std::string key_;
};

/// Calls work(), and adds a key to an EditError that it throws, see EditError::at().
template <class Key, class Work>
auto keyed(const Key& key, const Work& work) {
  try {
    return work();
  } catch (EditError& error) {
    error.at(key);
    throw;
  }
}
/// Returns the key of an entry of a list, as "handles[1]".
inline std::string entry_key(const std::string& list, std::size_t entry) {
  return list + "[" + std::to_string(entry) + "]";
}
/// Adds that key.
template <class Key, class Work>
auto keyed(const Key& list, std::size_t entry, const Work& work) {
  try {
    return work();
  } catch (EditError& error) {
    error.at(entry_key(list, entry));
    throw;
  }
}

}  // namespace lapedit
