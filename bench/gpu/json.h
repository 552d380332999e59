// Just enough JSON to write results: objects of numbers, texts and objects.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace hpm {

class Json {
 public:
  Json& Add(const std::string& name, double value) {
    char text[64];
    std::snprintf(text, sizeof(text), "%.9g", value);
    return AddRaw(name, std::isfinite(value) ? text : "null");
  }
  Json& Add(const std::string& name, const char* value) {
    std::string text = "\"";
    for (const char* c = value; *c != 0; ++c) {
      if (*c == '"' || *c == '\\') text += '\\';
      text += *c;
    }
    return AddRaw(name, text + '"');
  }
  Json& Add(const std::string& name, const Json& value) {
    return AddRaw(name, value.Text());
  }
  Json& Add(const std::string& name, const std::vector<Json>& values) {
    std::string text = "[";
    for (const Json& value : values) {
      text += (text.size() > 1 ? ",\n" : "") + value.Text();
    }
    return AddRaw(name, text + "]");
  }

  std::string Text() const { return "{" + members_ + "}"; }

 private:
  Json& AddRaw(const std::string& name, const std::string& value) {
    members_ += (members_.empty() ? "\"" : ", \"") + name + "\": " + value;
    return *this;
  }

  std::string members_;
};

}  // namespace hpm
