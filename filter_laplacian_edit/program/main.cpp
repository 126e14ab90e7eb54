// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "failure.h"
#include "files/system.h"
#include "job.h"
#include "lapedit/base/error.h"

namespace {

int fail(ExitCode code, const std::string& sentence) {
  std::fprintf(stderr, "%s\n", sentence.c_str());
  return code;
}

void work(const std::vector<std::string>& arguments, std::FILE* output) {
  std::string text;
  const std::optional<Options> options = readOptions(arguments, text);
  if (options && !options->asks()) {
    return runJob(*options, output);
  }
  printAll(options ? answer(*options) : text, output, "check where it is redirected");
}

}  // namespace

int main(int argc, char** argv) {
  std::FILE* const output = lapedit::system::prepareStreams() ? stdout : nullptr;
  try {
    work({argv + 1, argv + argc}, output);
    return Done;
  } catch (const Failure& failure) {
    return fail(failure.code(), failure.what());
  } catch (const lapedit::EditError& error) {
    return fail(Refused, error.what());
  } catch (const std::bad_alloc&) {
    return fail(Unexpected,
                "There was not enough memory: nothing was written; allow more (ulimit -v), or use a smaller mesh.");
  } catch (const std::exception& error) {
    return fail(Unexpected, std::string("An unexpected error: ") + error.what() +
                                "; nothing was written. Please report the command and its files.");
  }
}
