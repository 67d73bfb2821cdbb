/// Lines of G-code as a translator makes them from a program in another language.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers::translation {

/// @tparam Translator  made from text, file and setup; has next(), an optional GcodeLine, and
///                     take_warnings()
template <class Translator>
class TranslatedSource final : public LineSource {
 public:
  TranslatedSource(std::string text, const std::string& file, const ProgramSetup& setup)
      : translator_(std::move(text), file, setup) {}

  bool next(std::string& line, Place& place) override {
    auto made = translator_.next();
    if (!made) return false;
    line = std::move(made->text);
    place = std::move(made->place);
    unknowns_ = std::move(made->unknowns);
    return true;
  }
  LineUnknowns unknowns() const override { return unknowns_; }
  std::vector<Fault> take_warnings() override { return translator_.take_warnings(); }

 private:
  Translator translator_;
  LineUnknowns unknowns_;
};

}  // namespace servomill::controllers::translation
