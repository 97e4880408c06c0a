// SPDX-License-Identifier: Apache-2.0
#include "analysis/animation/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "core/escaped.h"
#include "plotting/html_plot.h"
#include "plotting/svg_text.h"

namespace slew::analysis {
namespace {

using plotting::colour_of;

constexpr double kMargin = 0.08;                   // share of a view's width
constexpr double kPictureWidth = 1000, kGap = 30;  // px
constexpr double kHeading = 60, kFaintest = 0.15;  // px; opacity of the first instant

constexpr std::string_view kPageStyle = R"(
body{font-family:sans-serif;margin:1em 1.5em;color:#222}h1{font-size:20px;margin:0}
.sub{color:#666;font-size:13px;margin:.2em 0 .8em}
canvas{display:inline-block;border:1px solid #ccc;width:calc(50% - 8px);height:70vh}
#bar{display:flex;gap:.8em;align-items:center;margin:.6em 0;font-size:14px}#time{flex:1}
#now{min-width:6.5em;font-variant-numeric:tabular-nums}
)";

// D.axes: right, to the viewer, up; D.gaps: times without a recorded pose, where the last one stays, faint; D.bodies:
// lines in body axes and, but for Ground, x y z w qx qy qz by instant
constexpr std::string_view kPageScript = R"(
const D=JSON.parse(document.getElementById('data').textContent),$=i=>document.getElementById(i);
const add=(a,b)=>[a[0]+b[0],a[1]+b[1],a[2]+b[2]],dot=(a,b)=>a[0]*b[0]+a[1]*b[1]+a[2]*b[2];
const turn=(q,p)=>{const[w,x,y,z]=q,n=w*w+x*x+y*y+z*z,u=[y*p[2]-z*p[1],z*p[0]-x*p[2],x*p[1]-y*p[0]],
 v=[y*u[2]-z*u[1],z*u[0]-x*u[2],x*u[1]-y*u[0]];return p.map((c,i)=>c+2*(w*u[i]+v[i])/n)};
const place=(b,k,p)=>{const s=D.bodies[b].pose;if(!s)return p;const o=7*k;return add(s.slice(o,o+3),turn(s.slice(o+3,o+7),p))};
const colour=b=>b==0?'#b5b5b5':D.colours[(b-1)%D.colours.length];
// extent of the motion over all instants, in both views
let reach=0,middle=[0,0,0];{let lo=[1/0,1/0,1/0],hi=[-1/0,-1/0,-1/0];
 D.bodies.forEach((b,i)=>{if(!b.pose)return;const step=Math.max(1,Math.floor(D.time.length/60));
  for(let k=0;k<D.time.length;k+=step)for(const p of[[0,0,0],...b.lines.flat()]){const q=place(i,k,p);for(let a=0;a<3;a++){lo[a]=Math.min(lo[a],q[a]);hi[a]=Math.max(hi[a],q[a])}}});
 if(lo[0]<=hi[0]){middle=lo.map((v,a)=>(v+hi[a])/2);reach=Math.max(...lo.map((v,a)=>hi[a]-v))*.58}if(!(reach>0))reach=1}
let k=0,playing=false,last=0,t=D.time[0];
const lacks=()=>D.gaps.some(([from,to])=>from<t&&t<to);
function view(canvas,right,up,title){const r=devicePixelRatio||1,W=canvas.clientWidth,H=canvas.clientHeight;canvas.width=W*r;canvas.height=H*r;
 const g=canvas.getContext('2d');g.setTransform(r,0,0,r,0,0);g.lineJoin='round';g.globalAlpha=lacks()?.25:1;
 const s=Math.min(W,H)/2/reach,px=p=>{const d=add(p,middle.map(v=>-v));return[W/2+s*dot(d,right),H/2-s*dot(d,up)]};
 const line=points=>{g.beginPath();points.forEach((p,i)=>{const[x,y]=px(p);i?g.lineTo(x,y):g.moveTo(x,y)});g.stroke()};
 D.bodies.forEach((b,i)=>{g.strokeStyle=colour(i);g.lineWidth=i?1.6:1;for(const l of b.lines)line(l.map(p=>place(i,k,p)))});
 g.strokeStyle='#222';g.lineWidth=4;for(const l of D.links)line([place(l.b1,k,l.p1),place(l.b2,k,l.p2)]);
 g.fillStyle='#444';g.font='13px sans-serif';g.fillText(title,10,18);
 const bar=[.01,.02,.05,.1,.2,.5,1,2,5,10,20,50,100,200,500].filter(m=>m*s<W/3).pop()||.01;g.fillRect(10,H-14,bar*s,3);g.fillText(bar+' m',10,H-20)}
function draw(){const f=+$('turn').value*Math.PI/180,[x,z,up]=D.axes,right=x.map((v,i)=>v*Math.cos(f)+z[i]*Math.sin(f));
 view($('side'),right,up,'side');view($('top'),x,z.map(v=>-v),'top');
 $('time').value=k;$('now').textContent=(+(lacks()?t:D.time[k]).toPrecision(9))+(lacks()?' s: not recorded':' s')}
function frame(now){if(playing){t+=(now-last)/1000*+$('speed').value;
 if(t>D.time[D.time.length-1]){t=D.time[0];k=0}while(k+1<D.time.length&&D.time[k+1]<=t)k++;draw();last=now;requestAnimationFrame(frame)}}
$('play').onclick=()=>{playing=!playing;$('play').textContent=playing?'pause':'play';last=performance.now();t=D.time[k];if(playing)requestAnimationFrame(frame)};
$('time').max=D.time.length-1;$('time').oninput=e=>{k=+e.target.value;t=D.time[k];draw()};$('turn').oninput=draw;addEventListener('resize',draw);
D.bodies.forEach((b,i)=>{const s=document.createElement('span');s.textContent=b.name+' ';s.style.color=colour(i);$('names').append(s)});
draw();
)";

std::string point_text(const Triple& p) {
  return fmt::format("[{:.6g},{:.6g},{:.6g}]", p[0], p[1], p[2]);
}

std::string joined(const std::vector<std::string>& parts) {
  return fmt::format("[{}]", fmt::join(parts, ","));
}

std::string data_text(const MachineDrawing& machine, const Motion& motion) {
  std::vector<std::string> bodies, links, axes, times, gaps, colours;
  for (std::size_t i = 0; i < machine.bodies.size(); ++i) {
    std::vector<std::string> lines;
    for (const Polyline& line : machine.bodies[i].lines) {
      std::vector<std::string> points;
      for (const Triple& point : line) points.push_back(point_text(point));
      lines.push_back(joined(points));
    }
    std::string body =
        fmt::format("{{\"name\":{},\"lines\":{}", plotting::json_string(machine.bodies[i].name), joined(lines));
    if (i > 0) {
      std::vector<std::string> poses;
      for (const Pose& pose : motion.poses[i - 1]) {
        const math::Vec3& x = pose.position;
        const math::Quaternion& q = pose.orientation;
        poses.push_back(
            fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", x[0], x[1], x[2], q.w, q.x, q.y, q.z));
      }
      body += ",\"pose\":" + joined(poses);
    }
    bodies.push_back(body + "}");
  }
  for (const LinkDrawing& link : machine.links) {
    links.push_back(fmt::format("{{\"b1\":{},\"p1\":{},\"b2\":{},\"p2\":{}}}", link.body1, point_text(link.point1),
                                link.body2, point_text(link.point2)));
  }
  for (const Triple& axis : machine.axes) axes.push_back(point_text(axis));
  for (const double time : motion.time) times.push_back(fmt::format("{:.12g}", time));
  for (const Gap& gap : motion.gaps) gaps.push_back(fmt::format("[{:.12g},{:.12g}]", gap.from, gap.to));
  for (const std::string_view colour : plotting::kColours) colours.push_back(plotting::json_string(colour));
  return fmt::format("{{\"colours\":{},\"axes\":{},\"time\":{},\"gaps\":{},\"bodies\":{},\"links\":{}}}",
                     joined(colours), joined(axes), joined(times), joined(gaps), joined(bodies), joined(links));
}

// ---- the picture

math::Vec3 placed(const Motion& motion, std::size_t body, std::size_t instant, const Triple& point) {
  if (body == 0) return to_vec(point);
  const Pose& pose = motion.poses[body - 1][instant];
  return pose.position + math::rotation_of(pose.orientation) * to_vec(point);
}

// One of the views: a plane, and the part of the motion that it has to hold.
class View {
 public:
  View(const Triple& right, const Triple& up) : right_(to_vec(right)), up_(to_vec(up)) {}
  void hold(const math::Vec3& point) {
    const std::array<double, 2> at = {math::dot(point, right_), math::dot(point, up_)};
    for (std::size_t i = 0; i < 2; ++i) low_[i] = std::min(low_[i], at[i]), high_[i] = std::max(high_[i], at[i]);
  }
  // width and left edge in px; the height that it takes
  double lay_out(double width, double left, double top) {
    const double reach = std::max({high_[0] - low_[0], high_[1] - low_[1], 1e-6});
    for (std::size_t i = 0; i < 2; ++i) low_[i] -= kMargin * reach, high_[i] += kMargin * reach;
    scale_ = width / (high_[0] - low_[0]);
    left_ = left;
    top_ = top;
    return scale_ * (high_[1] - low_[1]);
  }
  // parts outside are not visible
  [[nodiscard]] std::string clip(std::string_view id) const {
    return fmt::format(
        "<clipPath id=\"{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/></clipPath>\n", id,
        left_, top_, scale_ * (high_[0] - low_[0]), scale_ * (high_[1] - low_[1]));
  }
  [[nodiscard]] std::string at(const math::Vec3& point) const {
    return fmt::format("{:.1f},{:.1f}", left_ + scale_ * (math::dot(point, right_) - low_[0]),
                       top_ + scale_ * (high_[1] - math::dot(point, up_)));
  }

 private:
  math::Vec3 right_, up_;
  std::array<double, 2> low_ = {kFar, kFar}, high_ = {-kFar, -kFar};
  double scale_ = 1, left_ = 0, top_ = 0;

  static constexpr double kFar = std::numeric_limits<double>::infinity();
};

void add_line(std::string& out, const View& view, const std::vector<math::Vec3>& points, std::string_view style) {
  out += "<polyline points=\"";
  for (const math::Vec3& point : points) out += view.at(point) + " ";
  fmt::format_to(std::back_inserter(out), "\" fill=\"none\" {}/>\n", style);
}

void add_instant(std::string& out, const View& view, const MachineDrawing& machine, const Motion& motion,
                 std::size_t instant, double opacity) {
  fmt::format_to(std::back_inserter(out), "<g opacity=\"{:.2f}\">\n", opacity);
  for (std::size_t body = 1; body < machine.bodies.size(); ++body) {
    const std::string style = fmt::format("stroke=\"{}\" stroke-width=\"1.4\"", colour_of(body - 1));
    for (const Polyline& line : machine.bodies[body].lines) {
      std::vector<math::Vec3> points;
      for (const Triple& point : line) points.push_back(placed(motion, body, instant, point));
      add_line(out, view, points, style);
    }
  }
  for (const LinkDrawing& link : machine.links) {
    add_line(out, view,
             {placed(motion, link.body1, instant, link.point1), placed(motion, link.body2, instant, link.point2)},
             "stroke=\"#222222\" stroke-width=\"3\"");
  }
  out += "</g>\n";
}

}  // namespace

namespace {

Motion chosen(const Motion& motion, const std::vector<std::size_t>& instants) {
  Motion thin{motion.title, motion.subtitle, {}, std::vector<std::vector<Pose>>(motion.poses.size()), motion.gaps};
  for (const std::size_t k : instants) {
    thin.time.push_back(motion.time[k]);
    for (std::size_t body = 0; body < motion.poses.size(); ++body) thin.poses[body].push_back(motion.poses[body][k]);
  }
  return thin;
}

}  // namespace

Motion thinned(const Motion& motion, std::size_t instants) {
  const std::size_t count = motion.time.size();
  if (count <= instants) return motion;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < instants; ++i) kept.push_back(instants == 1 ? 0 : i * (count - 1) / (instants - 1));
  return chosen(motion, kept);
}

std::size_t stride_for(const Motion& motion, std::size_t most) {
  const std::size_t steps = motion.time.empty() ? 0 : motion.time.size() - 1;
  return std::max<std::size_t>(1, (steps + most - 2) / (most - 1));
}

Motion every_nth(const Motion& motion, std::size_t n) {
  if (n == 1) return motion;
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k + 1 < motion.time.size(); k += n) kept.push_back(k);
  if (!motion.time.empty()) kept.push_back(motion.time.size() - 1);
  return chosen(motion, kept);
}

std::string animation_html(const MachineDrawing& machine, const Motion& motion) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{1}</style>\n"
      "</head>\n<body>\n<h1>{0}</h1>\n<p class=\"sub\">{2}: <span id=\"names\"></span></p>\n<div id=\"bar\"><button "
      "id=\"play\">play</button><input id=\"time\" type=\"range\" min=\"0\" value=\"0\"><span id=\"now\"></span><label>"
      "speed <select id=\"speed\"><option>0.1</option><option>0.25</option><option "
      "selected>1</option><option>2</option>"
      "<option>5</option></select></label><label>side view turned by <input id=\"turn\" type=\"range\" min=\"-180\" "
      "max=\"180\" value=\"0\"></label></div>\n<canvas id=\"side\"></canvas> <canvas id=\"top\"></canvas>\n<script "
      "type=\"application/json\" id=\"data\">{3}</script>\n<script>{4}</script>\n</body>\n</html>\n",
      escaped(motion.title), kPageStyle, escaped(motion.subtitle), plotting::in_script(data_text(machine, motion)),
      kPageScript);
}

std::string animation_svg(const MachineDrawing& machine, const Motion& motion) {
  const auto& [right, to_viewer, up] = machine.axes;
  View side(right, up), top(right, {-to_viewer[0], -to_viewer[1], -to_viewer[2]});
  const std::size_t count = motion.time.size();
  for (View* view : {&side, &top}) {
    for (std::size_t body = 1; body < machine.bodies.size(); ++body) {
      for (std::size_t k = 0; k < count; ++k) {
        view->hold(placed(motion, body, k, {}));
        for (const Polyline& line : machine.bodies[body].lines) {
          for (const Triple& point : line) view->hold(placed(motion, body, k, point));
        }
      }
    }
    for (const LinkDrawing& link : machine.links) {
      for (std::size_t k = 0; k < count; ++k) {
        view->hold(placed(motion, link.body1, k, link.point1));
        view->hold(placed(motion, link.body2, k, link.point2));
      }
    }
  }
  const double width = (kPictureWidth - kGap) / 2;
  const double height =
      std::max(side.lay_out(width, 0, kHeading), top.lay_out(width, width + kGap, kHeading)) + kHeading;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n"
      "<style>{2}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n<text class=\"title\" x=\"12\" "
      "y=\"22\">{3}</text>\n<text class=\"sub\" x=\"12\" y=\"40\">{4}; from {5:.6g} s, faint, to {6:.6g} "
      "s</text>\n<text "
      "class=\"heading\" x=\"12\" y=\"58\">side</text>\n<text class=\"heading\" x=\"{7:.0f}\" y=\"58\">top</text>\n",
      kPictureWidth, height, plotting::kStyle, escaped(motion.title), escaped(motion.subtitle), motion.time.front(),
      motion.time.back(), width + kGap);
  for (const auto& [view, name] : {std::pair(&side, "side"), std::pair(&top, "top")}) {
    out += view->clip(name) + fmt::format("<g clip-path=\"url(#{})\">\n", name);
    for (const Polyline& line : machine.bodies[0].lines) {
      std::vector<math::Vec3> points;
      for (const Triple& point : line) points.push_back(to_vec(point));
      add_line(out, *view, points, "stroke=\"#b5b5b5\"");
    }
    for (std::size_t k = 0; k < count; ++k) {
      const double share = count == 1 ? 1 : static_cast<double>(k) / static_cast<double>(count - 1);
      add_instant(out, *view, machine, motion, k, kFaintest + (1 - kFaintest) * share * share);
    }
    out += "</g>\n";
  }
  return out + "</svg>\n";
}

}  // namespace slew::analysis
