// SPDX-License-Identifier: BSD-3-Clause
#include "region.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace conceg::exporting {
namespace {

using Wide = __int128;
using Row = std::uint32_t;
constexpr Row kNone = ~0u;

class Region {
public:
  Region(const std::vector<PlanePoint> &point, const std::function<void(Row, Row, Row)> &use)
      : point_(point), use_(use), next_(point.size(), kNone), previous_(point.size(), kNone),
        place_(point.size(), status_.end()), helper_(point.size(), kNone), out_(point.size()) {}

  std::int64_t run(const std::vector<std::pair<Row, Row>> &edges) {
    for (const auto &[a, b] : edges) {
      if (next_[a] != kNone) return a;
      if (previous_[b] != kNone) return b;
      next_[a] = b, previous_[b] = a;
    }
    std::vector<Row> order;
    for (Row p = 0; p < point_.size(); p++) {
      if ((next_[p] == kNone) != (previous_[p] == kNone)) return p;
      if (next_[p] != kNone) order.push_back(p);
    }
    std::sort(order.begin(), order.end(), [&](Row a, Row b) { return earlier(a, b); });
    for (std::size_t i = 1; i < order.size(); i++)
      if (!earlier(order[i - 1], order[i])) return order[i];
    for (const Row p : order) {
      sweep(p);
      if (bad_ != kNone) return bad_;
    }
    cut_into_pieces(order);
    return bad_ == kNone ? -1 : static_cast<std::int64_t>(bad_);
  }

private:
  // By v, then by u: the order of a sweep line that leans a little.
  bool earlier(Row a, Row b) const {
    const PlanePoint &p = point_[a], &q = point_[b];
    return p.v != q.v ? p.v < q.v : p.u < q.u;
  }

  Wide turn(Row a, Row b, Row c) const {
    const PlanePoint &p = point_[a], &q = point_[b], &r = point_[c];
    return Wide(q.u - p.u) * (r.v - p.v) - Wide(q.v - p.v) * (r.u - p.u);
  }

  // An edge that falls has the region to its right. It is named by its upper end, from which it leaves.
  struct Left {
    const Region *region;
    Row low, high;
    bool operator<(const Left &other) const { // both are under the sweep line
      const bool begins_first = region->earlier(low, other.low);
      const Wide side =
          begins_first ? region->turn(low, high, other.low) : -region->turn(other.low, other.high, low);
      return side != 0 ? side < 0 : low != other.low && region->turn(low, high, other.high) < 0;
    }
  };
  using Status = std::map<Left, Row>; // to the upper end

  void insert(Row high, Row low) {
    helper_[high] = low;
    const auto [at, fresh] = status_.insert({{this, low, high}, high});
    place_[high] = at;
    if (!fresh) bad_ = low;
  }
  void remove(Row high) {
    if (place_[high] == status_.end()) {
      bad_ = high;
      return;
    }
    status_.erase(place_[high]), place_[high] = status_.end();
  }
  // The edge next to the left of a point, by its upper end.
  Row left_of(Row p) {
    auto at = status_.lower_bound(Left{this, p, p});
    if (at == status_.begin()) {
      bad_ = p;
      return kNone;
    }
    return (--at)->second;
  }

  bool is_merge(Row p) const {
    return earlier(next_[p], p) && earlier(previous_[p], p) && turn(previous_[p], p, next_[p]) < 0;
  }
  void join(Row a, Row b) { out_[a].push_back(b), out_[b].push_back(a); }
  void join_if_merge(Row p, Row edge) {
    if (is_merge(helper_[edge])) join(p, helper_[edge]);
  }

  void sweep(Row p) {
    const Row a = previous_[p], b = next_[p];
    const bool a_later = earlier(p, a), b_later = earlier(p, b);
    const Wide bend = turn(a, p, b);
    if (a_later == b_later && bend == 0) {
      bad_ = p;
    } else if (a_later && b_later) { // begin of a piece, or split
      if (bend < 0) {
        const Row left = left_of(p);
        if (bad_ != kNone) return;
        join(p, helper_[left]), helper_[left] = p;
      }
      insert(a, p);
    } else if (!a_later && !b_later) { // end of a piece, or merge
      join_if_merge(p, p);
      remove(p);
      if (bend < 0) pass_left(p);
    } else if (a_later) { // falls: the region is to the right
      join_if_merge(p, p);
      remove(p);
      insert(a, p);
    } else {
      pass_left(p);
    }
  }
  void pass_left(Row p) {
    if (bad_ != kNone) return;
    const Row left = left_of(p);
    if (bad_ != kNone) return;
    join_if_merge(p, left), helper_[left] = p;
  }

  // Is the direction p -> x met before p -> y when turning clockwise from p -> from?
  bool sooner(Row p, Row from, Row x, Row y) const {
    const auto half = [&](Row q) { // clockwise of `from` by less than half a round, half, more, all of it
      const Wide t = turn(p, from, q);
      return q == from ? 3 : t < 0 ? 0 : t > 0 ? 2 : 1;
    };
    const int hx = half(x), hy = half(y);
    return hx != hy ? hx < hy : turn(p, x, y) < 0;
  }

  // Faces of the graph of edges and joins, each a monotone piece.
  void cut_into_pieces(const std::vector<Row> &order) {
    for (const Row p : order)
      out_[p].push_back(next_[p]);
    std::vector<Row> piece;
    for (const Row first : order)
      while (!out_[first].empty() && bad_ == kNone) {
        piece = {first};
        Row at = first, to = take(first, kNone);
        while (to != first && bad_ == kNone) {
          piece.push_back(to);
          const Row after = take(to, at);
          at = to, to = after;
          if (to == kNone || piece.size() > point_.size() * 3) bad_ = at;
        }
        if (bad_ == kNone) cover(piece);
      }
  }
  Row take(Row p, Row from) {
    std::vector<Row> &ways = out_[p];
    if (ways.empty()) return kNone;
    std::size_t best = 0;
    for (std::size_t i = 1; i < ways.size() && from != kNone; i++)
      if (sooner(p, from, ways[i], ways[best])) best = i;
    const Row to = ways[best];
    ways.erase(ways.begin() + static_cast<std::ptrdiff_t>(best));
    return to;
  }

  struct Step {
    Row p;
    bool right; // on the rising chain
  };

  // One monotone piece, anticlockwise.
  void cover(const std::vector<Row> &piece) {
    const std::size_t n = piece.size();
    if (n < 3) {
      bad_ = piece[0];
      return;
    }
    std::size_t low = 0, high = 0;
    for (std::size_t i = 1; i < n; i++) {
      if (earlier(piece[i], piece[low])) low = i;
      if (earlier(piece[high], piece[i])) high = i;
    }
    std::vector<Step> step;
    for (std::size_t i = low; i != high; i = (i + 1) % n)
      step.push_back({piece[i], true});
    for (std::size_t i = high; i != low; i = (i + 1) % n)
      step.push_back({piece[i], false});
    std::sort(step.begin(), step.end(), [&](const Step &l, const Step &r) { return earlier(l.p, r.p); });
    std::vector<Step> stack = {step[0], step[1]};
    stack[0].right = stack[1].right;
    for (std::size_t i = 2; i < n; i++) {
      Step now = step[i];
      if (i + 1 == n) now.right = stack.back().right; // the last point ends both chains
      if (now.right == stack.back().right) {
        while (stack.size() > 1 && bulges(stack[stack.size() - 2].p, stack.back().p, now))
          emit(stack[stack.size() - 2].p, stack.back().p, now.p, now.right), stack.pop_back();
      } else {
        for (std::size_t k = 0; k + 1 < stack.size(); k++)
          emit(stack[k].p, stack[k + 1].p, now.p, stack.back().right);
        stack = {stack.back()};
        stack[0].right = now.right;
      }
      stack.push_back(now);
    }
    if (stack.size() != 2) bad_ = stack[0].p;
  }
  bool bulges(Row a, Row b, const Step &c) const {
    return c.right ? turn(a, b, c.p) > 0 : turn(a, b, c.p) < 0;
  }
  void emit(Row a, Row b, Row c, bool right) {
    const Wide area = turn(a, b, c);
    if (right ? area <= 0 : area >= 0) bad_ = b;
    right ? use_(a, b, c) : use_(a, c, b);
  }

  const std::vector<PlanePoint> &point_;
  const std::function<void(Row, Row, Row)> &use_;
  std::vector<Row> next_, previous_;
  Status status_;
  std::vector<Status::iterator> place_; // per upper end
  std::vector<Row> helper_;             // per upper end
  std::vector<std::vector<Row>> out_;   // joins, and at the end the edges too
  Row bad_ = kNone;
};

} // namespace

std::int64_t triangulate_region(const std::vector<PlanePoint> &point,
                                const std::vector<std::pair<std::uint32_t, std::uint32_t>> &edge,
                                const std::function<void(std::uint32_t, std::uint32_t, std::uint32_t)> &use) {
  return Region(point, use).run(edge);
}

} // namespace conceg::exporting
