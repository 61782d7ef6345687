// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/markup.h"

#include <cassert>

#include "app/page/text_forms.h"

namespace meshlode::lab::page {

void Markup::start(std::string_view tag, std::initializer_list<Attribute> attributes) {
  out_ += '<';
  out_ += tag;
  for (const Attribute& attribute : attributes) {
    out_ += ' ';
    out_ += attribute.name;
    out_ += "=\"";
    out_ += app::escape_html(attribute.value);
    out_ += '"';
  }
}

Markup& Markup::open(std::string_view tag, std::initializer_list<Attribute> attributes) {
  start(tag, attributes);
  out_ += '>';
  open_.emplace_back(tag);
  return *this;
}

Markup& Markup::close() {
  assert(!open_.empty());
  out_ += "</" + open_.back() + ">";
  open_.pop_back();
  return *this;
}

Markup& Markup::empty(std::string_view tag, std::initializer_list<Attribute> attributes) {
  start(tag, attributes);
  out_ += "/>";
  return *this;
}

Markup& Markup::text(std::string_view text) {
  out_ += app::escape_html(text);
  return *this;
}

Markup& Markup::element(std::string_view tag, std::string_view text, std::initializer_list<Attribute> attributes) {
  open(tag, attributes);
  out_ += app::escape_html(text);
  return close();
}

Markup& Markup::raw(std::string_view markup) {
  out_ += markup;
  return *this;
}

const std::string& Markup::str() const {
  assert(open_.empty());
  return out_;
}

}  // namespace meshlode::lab::page
