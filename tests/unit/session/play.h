// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "drag_support.h"
#include "lapedit/mesh/weld.h"

namespace lapedit::support {

inline TriangleMesh plate() {
  TriangleMesh mesh = shapes::grid(60, 60);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) = 0.3 * std::sin(mesh.vertices(v, 0)) * std::cos(0.8 * mesh.vertices(v, 1));
  }
  return mesh;
}

inline TriangleMesh hills() {
  TriangleMesh mesh = shapes::grid(60, 60);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) = std::sin(0.9 * mesh.vertices(v, 0)) * std::cos(0.7 * mesh.vertices(v, 1));
  }
  return mesh;
}

/// Sends events to a session of a grid of 60 x 60 vertices, and checks what it has then. A script is commands with
/// semicolons between: "30,31" is the vertex at x = 30, y = 31, "25..35,30" are eleven, and a text is in apostrophes.
/// "keep a" keeps the state, which "same", "other" and "more" compare with; the first one is "rest".
class Play {
 public:
  explicit Play(const TriangleMesh& mesh = plate()) : window(mesh) { keep("rest"); }

  /// In the end host, session and record have to be the same to the bit.
  Window& run(const std::string& script) {
    std::istringstream commands(script);
    for (std::string command; std::getline(commands, command, ';') && !testing::Test::HasFailure();) {
      SCOPED_TRACE(command);
      std::istringstream in(command);
      in >> name_ >> std::ws;
      words_.clear();
      for (std::string word; in.good(); in >> std::ws) {
        in.peek() == '\'' ? (in.get(), std::getline(in, word, '\'')) : in >> word;
        words_.push_back(word);
      }
      send_or_check();
    }
    window.session.cancel();
    window.session.wait();
    window.expect_consistent();
    return window;
  }

  Window window;

 private:
  struct Kept {
    Points pose;
    std::vector<int> region, held;
    std::vector<std::vector<int>> groups;
    KeptAnchors anchors;
    DragSettings settings;
  };

  bool on(const char* name) const { return name_ == name; }
  bool is(std::size_t k, const char* word) const { return k < words_.size() && words_[k] == word; }
  double number(std::size_t k) const { return std::stod(words_.at(k)); }
  Vector3 vector(std::size_t k) const { return {number(k), number(k + 1), number(k + 2)}; }
  int vertex(std::size_t k) const { return vertices(words_.at(k)).at(0); }
  PressModifiers modifiers() const { return {!words_.empty() && words_.back() == "add", words_.back() == "take"}; }
  /// The position of one of the names in the first word.
  template <class Value>
  Value choice(const std::vector<std::string>& names) const {
    return static_cast<Value>(std::find(names.begin(), names.end(), words_.at(0)) - names.begin());
  }

  static std::vector<int> vertices(const std::string& word) {
    const std::size_t comma = word.find(','), dots = word.find("..");
    std::vector<int> result = {60 * std::stoi(word) + std::stoi(word.substr(comma + 1))};
    for (int i = std::stoi(word); dots < comma && i < std::stoi(word.substr(dots + 2)); ++i) {
      result.push_back(result.back() + 60);
    }
    return result;
  }
  /// All that are named; groups have a slash between.
  std::vector<std::vector<int>> groups() const {
    std::vector<std::vector<int>> found;
    for (const std::string& word : words_) {
      found.resize(std::max<std::size_t>(found.size(), word == "none" ? 0 : 1));
      if (word == "/") {
        found.emplace_back();
      } else if (word != "none") {
        found.back() = united(found.back(), vertices(word));
      }
    }
    return found;
  }
  std::vector<int> named() const { return groups().empty() ? std::vector<int>() : groups()[0]; }
  Vector2 off() const { return {number(1), number(2)}; }
  Cursor cursor() const { return words_.size() > 2 ? window.at(vertex(0), off()) : window.at(vertex(0)); }
  Vector3 way(std::size_t k) {
    return (window.host().row(vertex(k)) - window.session.original().vertices.row(vertex(k))).transpose();
  }

  const Region& region() const {
    static const Region none;
    return window.session.shown().region() ? *window.session.shown().region() : none;
  }

  Kept keep(const std::string& name) {
    const Selection& s = window.session.selection();
    const KeptAnchors anchors = region().distance.empty() ? KeptAnchors() : anchors_of(region());
    return kept_[name] = {window.host(), region().mesh_vertex, s.held, s.groups, anchors, window.session.settings()};
  }

  static double& setting(DragSettings& s, const std::string& name) {
    const std::map<std::string, double*> reals = {{"radius", &s.radius},        {"padding", &s.padding},
                                                  {"disc", &s.handle_fraction}, {"brush", &s.brush_pixels},
                                                  {"gap", &s.connect_gap},      {"membrane", &s.edit.membrane},
                                                  {"detail", &s.edit.detail}};
    return *reals.at(name);
  }
  void set() {
    DragSettings s = window.session.settings();
    for (std::size_t k = is(0, "now") || is(0, "passing") ? 1 : 0; k < words_.size(); k += 2) {
      if (words_[k] == "order") {
        s.edit.order = static_cast<int>(number(k + 1));
      } else if (words_[k] == "falloff") {
        s.falloff = static_cast<Falloff>(number(k + 1));
      } else {
        setting(s, words_[k]) = number(k + 1);
      }
    }
    window.session.set_settings(s, is(0, "passing"));
    if (!is(0, "now")) window.session.wait();
  }

  void stroke() {
    const Vector2 from = window.at(vertex(0)).pixel, to = window.at(vertex(1)).pixel;
    window.press(vertex(0), modifiers());
    for (const double fraction : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      window.session.move(window.at((1 - fraction) * from + fraction * to));
    }
    window.session.release(window.at(to));
  }

  void take_block() {
    std::vector<int> block;
    for (int v = is(0, "none") ? 1 : vertex(0); v <= (is(0, "none") ? 0 : vertex(1)); ++v) {
      if (v % 60 >= vertex(0) % 60 && v % 60 <= vertex(1) % 60) block.push_back(v);
    }
    window.session.set_painted(BrushTarget::Region, block);
  }

  void move_last() {
    HandleTransform motion = window.session.last_step().value_or(LastStep()).motion;
    motion.translation = vector(0);
    window.session.set_last_step(motion, number(3), is(4, "passing"));
  }

  template <class A, class B>
  static void equal(const A& now, const B& expected) {
    EXPECT_EQ(now, static_cast<A>(expected));
  }
  void expect(bool holds) const { EXPECT_TRUE(holds) << window.session.message(); }
  void all_in(const std::vector<int>& set, bool expected) const {
    for (const int v : named()) EXPECT_EQ(contains(set, v), expected) << "vertex " << v;
  }

  void compare() {
    const Kept before = kept_.at(words_.at(1)), now = keep("now");
    const std::vector<int>&old = before.region, &region = now.region;
    const KeptAnchors &a = before.anchors, &b = now.anchors;
    if (on("more")) {
      return expect(region.size() > old.size() && std::includes(region.begin(), region.end(), old.begin(), old.end()));
    }
    const std::map<std::string, bool> same = {
        {"pose", same_bits(now.pose, before.pose)},
        {"region", region == old},
        {"held", now.held == before.held},
        {"groups", now.groups == before.groups},
        {"anchors",
         std::tie(a.vertices, a.weights, a.depths, a.reach) == std::tie(b.vertices, b.weights, b.depths, b.reach)},
        {"settings", now.settings.radius == before.settings.radius && now.settings.edit == before.settings.edit}};
    equal(same.at(words_[0]), on("same"));
  }

  /// Compares numbers of a step of the record.
  void recorded() {
    const EditStep step = window.session.recorded().steps.at(static_cast<std::size_t>(number(0)));
    const HandleGroup first = step.handles.empty() ? HandleGroup() : step.handles[0];
    const Vector3& t = first.transform.translation;
    std::vector<double> degrees;
    for (const HandleGroup& group : step.handles) degrees.push_back(group.transform.degrees);
    const std::map<std::string, std::vector<double>> values = {{"membrane", {step.settings.membrane}},
                                                               {"padding", {step.region.padding}},
                                                               {"gap", {step.region.connect_gap}},
                                                               {"handles", {1.0 * step.handles.size()}},
                                                               {"targets", {1.0 * first.targets.size()}},
                                                               {"detail", {step.settings.detail}},
                                                               {"anchors", {1.0 * step.region.anchors.vertices.size()}},
                                                               {"degrees", degrees},
                                                               {"translation", {t.x(), t.y(), t.z()}}};
    for (std::size_t k = 2; k < words_.size(); ++k) equal(values.at(words_[1]).at(k - 2), number(k));
  }

  void send_or_check() {
    DragSession& s = window.session;
    const Selection& selection = s.selection();
    const int times = words_.empty() ? 1 : std::atoi(words_[0].c_str());
    if (on("keep")) return void(keep(words_.at(0)));
    // Events.
    if (on("set")) return set();
    if (on("click")) return window.click(vertex(0), modifiers());
    if (on("press")) return void(s.press(cursor(), modifiers()));
    if (on("move")) return s.move(cursor());
    if (on("release")) return s.release(cursor());
    if (on("drag")) return window.drag(vertex(0), off(), modifiers());
    if (on("stroke")) return stroke(), s.wait();
    if (on("keys")) return window.keys(words_.at(0));
    if (on("enter")) return window.keys("\r");
    if (on("mode")) return s.set_mode(choice<HandleMode>({"vertex", "curve"}));
    if (on("paint")) {
      const auto target = choice<int>({"region", "handle", "anchors", "off"});
      return s.set(&Tools::paint, target < 3 ? std::optional(static_cast<BrushTarget>(target)) : std::nullopt);
    }
    if (on("change")) return s.change_painted(choice<PaintChange>({"invert", "blur", "clear"})), s.wait();
    if (on("pivot")) return s.set(&Tools::pivot, choice<Pivot>({"centroid", "boundary", "point"}));
    if (on("mirror")) return s.set(&Tools::mirror, MirrorPlane{Vector3(number(0), 0, 0), Vector3::UnitX()}), s.wait();
    if (on("unmirror")) return s.set(&Tools::mirror, std::nullopt), s.wait();
    if (on("undo")) return window.undo(times);
    if (on("redo")) return window.redo(times);
    if (on("back")) return s.go_to(times);
    if (on("wait")) return s.wait();
    if (on("cancel")) return s.cancel(), s.wait();
    if (on("finish")) return expect(s.finish(std::chrono::seconds(times)));
    if (on("reload")) return s.load(s.recorded());
    if (on("clear")) return s.clear();
    if (on("whole")) return s.whole_component(), s.wait();
    if (on("handle")) return s.set_painted(BrushTarget::Handle, named()), s.wait();
    if (on("anchors")) return s.set_painted(BrushTarget::Anchors, named()), s.wait();
    if (on("region")) return take_block(), s.wait();
    if (on("last")) return move_last(), s.wait();
    // Checks.
    if (on("same") || on("other") || on("more")) return compare();
    if (on("says")) return expect(window.says(words_.at(0)));
    if (on("silent")) return expect(!window.says(words_.at(0)));
    if (on("steps")) return equal(s.figures().steps, number(0));
    if (on("actions")) return equal(s.timeline().done().size(), number(0));
    if (on("logged")) return equal(window.log.size(), number(0));
    if (on("state")) return equal(s.state(), choice<DragSession::State>({"idle", "picked", "dragging", "settling"}));
    if (on("ready")) return expect(s.preparation().ready);
    if (on("unready")) return expect(!s.preparation().ready && !s.busy());
    if (on("can")) return expect(is(0, "undo") ? s.can_undo() : s.can_redo());
    if (on("cannot")) return expect(!(is(0, "undo") ? s.can_undo() : s.can_redo()));
    if (on("unposed")) return equal(window.poses(), 0);
    if (on("settled")) return equal(window.settled(), !is(0, "not"));
    if (on("groups")) return equal(selection.groups, groups());
    if (on("count")) return equal(selection.groups.size(), number(0));
    if (on("points")) return equal(selection.discs.curves.at(0).points.size(), number(0));
    if (on("size"))
      return equal(selection.groups.at(words_.size() > 1 ? static_cast<std::size_t>(number(1)) : 0).size(), number(0));
    if (on("active")) return equal(selection.active, number(0));
    if (on("moving")) {  // the groups that do, in their order
      std::vector<std::string> moving;
      for (int g = 0; g < static_cast<int>(selection.groups.size()); ++g) {
        if (selection.moves(g)) moving.push_back(std::to_string(g));
      }
      return equal(moving, words_);
    }
    if (on("in")) return all_in(region().mesh_vertex, true);
    if (on("out")) return all_in(region().mesh_vertex, false);
    if (on("held")) return all_in(selection.held, true);
    if (on("unheld")) return all_in(selection.held, false);
    if (on("painted")) return all_in(selection.groups.at(0), true);
    if (on("unpainted")) return all_in(selection.groups.at(0), false);
    if (on("loose")) return named().empty() ? expect(s.unconnected().empty()) : all_in(s.unconnected(), true);
    if (on("anchor")) {
      const int at = index_in(region().mesh_vertex, vertex(0));
      return equal(at >= 0 && region().classes[static_cast<std::size_t>(at)] == VertexClass::Anchor, !is(1, "not"));
    }
    if (on("moved")) return expect((way(0) - vector(1)).norm() < number(4));
    if (on("under")) {  // the vertex appears where its first position was, moved by some pixels
      const auto pixel = [&](const Points& points) { return window.view.pixel(points.row(vertex(0)).transpose()); };
      return expect((pixel(window.host()) - pixel(s.original().vertices) - off()).norm() < 0.1);
    }
    if (on("images")) return expect((way(0) - Vector3(-1, 1, 1).cwiseProduct(way(1))).norm() < 0.1 * way(0).norm());
    if (on("together")) return expect((way(0) - way(1)).norm() < 0.01 * way(0).norm());
    if (on("rests")) return expect(way(0).norm() < number(2) * way(1).norm());
    if (on("closed")) {  // all that was at one place still is
      const Weld weld(s.original().vertices);
      expect(!weld.empty());
      for (int v = 0; v < window.host().rows(); ++v)
        equal(window.host().row(v), window.host().row(weld.representative(v)));
      return;
    }
    if (on("deep")) return expect(std::abs(window.host().col(2).cwiseAbs().maxCoeff() - number(0)) < 0.02);
    if (on("has")) {
      DragSettings settings = s.settings();
      return equal(setting(settings, words_[0]), number(1));
    }
    if (on("no_last")) return expect(!s.last_step());
    if (on("last_is"))
      return expect(s.last_step()->motion.translation == vector(0) && s.last_step()->fraction == number(3));
    if (on("recorded")) return recorded();
    if (on("consistent")) return window.expect_consistent();
    ADD_FAILURE() << "there is no command " << name_;
  }

  std::string name_;
  std::vector<std::string> words_;
  std::map<std::string, Kept> kept_;
};

inline void play(const std::string& script, const TriangleMesh& mesh = plate()) {
  Play(mesh).run(script);
}

}  // namespace lapedit::support
