// SPDX-License-Identifier: Apache-2.0
#include "plotting/html_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <vector>

#include "core/escaped.h"
#include "core/json.h"
#include "plotting/svg_text.h"

namespace slew::plotting {
namespace {

constexpr std::string_view kPageStyle = R"(
body{font-family:sans-serif;margin:1em 1.5em;color:#222}
h1{font-size:20px;margin:0}h2{font-size:15px;margin:1em 0 0}
.sub{color:#666;font-size:13px;margin:.2em 0}
.legend{font-size:13px;margin:.7em 0 .2em 66px}
.legend span{display:inline-block;margin-right:1.4em;cursor:pointer;white-space:pre}
.legend .off{opacity:.35}
.legend i{display:inline-block;width:18px;height:0;border-top:3px solid;margin-right:5px;vertical-align:middle}
.legend b{display:inline-block;min-width:9.5em;font-weight:normal;font-variant-numeric:tabular-nums;color:#000;padding:0 .3em}
canvas{display:block;width:100%;touch-action:none;cursor:crosshair}
)";

// D.colours: of curves; D.height: of a plot area [px]; D.times: time axes [s]; D.plots: panels with curves of one unit,
// t the number of their axis
constexpr std::string_view kPageScript = R"(
const D=JSON.parse(document.getElementById('data').textContent);
const L=66,R=16,T=6,B=22,colours=D.colours;
const axes=D.times.map(t=>{const cuts=[0];for(let i=1;i<t.length;i++)if(t[i]<t[i-1])cuts.push(i);cuts.push(t.length);return{t,cuts}});
let low=Infinity,high=-Infinity;for(const{t}of axes)for(const x of t){if(x<low)low=x;if(x>high)high=x}
if(!(low<high)){low=(isFinite(low)?low:0)-.5;high=low+1}
let a=low,b=high,pointer=null,drag=null;
const panels=[];
// last index with t[i]<=x in [from,to), or -1
function last(t,x,from,to){if(!(t[from]<=x))return -1;while(to-from>1){const m=(from+to)>>1;if(t[m]<=x)from=m;else to=m}return from}
// the previous sample; after a reset of the session the later line
function sample(axis,x){for(let k=axis.cuts.length-2;k>=0;k--){const s=axis.cuts[k],e=axis.cuts[k+1];if(s>=e)continue;
 const i=last(axis.t,x,s,e);if(i>=0)return i}return -1}
const digits=v=>v==null?'no value':Math.abs(v)>=1e5||(v!=0&&Math.abs(v)<1e-3)?v.toExponential(4):+v.toPrecision(6)+'';
function ticks(lo,hi,n){const raw=(hi-lo)/Math.max(1,n),p=10**Math.floor(Math.log10(raw)),s=[1,2,5,10].find(m=>m*p>=raw)*p,out=[];
 for(let k=Math.ceil(lo/s-1e-9);k*s<=hi+1e-9*s;k++)out.push(+(k*s).toPrecision(12));return out}
for(const plot of D.plots){if(plot.title){const h=document.createElement('h2');h.textContent=plot.title;document.body.append(h)}
 for(const p of plot.panels){const legend=document.createElement('div'),canvas=document.createElement('canvas');
  legend.className='legend';canvas.style.height=D.height+T+B+'px';document.body.append(legend,canvas);
  p.curves.forEach((c,k)=>{const s=document.createElement('span'),i=document.createElement('i');c.value=document.createElement('b');
   c.colour=colours[k%colours.length];c.dash=k>=colours.length?[7,4]:[];i.style.borderTopColor=c.colour;if(c.dash.length)i.style.borderTopStyle='dashed';
   s.append(i,c.name+(p.unit?' ['+p.unit+'] ':' '),c.value);
   s.onclick=()=>{c.hidden=!c.hidden;s.className=c.hidden?'off':'';draw()};legend.append(s)});
  const panel={p,canvas};panels.push(panel);
  const time=e=>a+(e.offsetX-L)/(canvas.clientWidth-L-R)*(b-a);
  canvas.onpointermove=e=>{pointer=time(e);if(drag){if(drag.moves){const d=drag.at-pointer;view(a+d,b+d)}else drag.to=pointer}draw()};
  canvas.onpointerleave=()=>{if(!drag){pointer=null;draw()}};
  canvas.onpointerdown=e=>{canvas.setPointerCapture(e.pointerId);drag={at:time(e),to:time(e),x:e.offsetX,moves:e.shiftKey||e.button==1}};
  canvas.onpointerup=e=>{const d=drag;drag=null;if(d&&!d.moves&&Math.abs(e.offsetX-d.x)>4)view(Math.min(d.at,d.to),Math.max(d.at,d.to));draw()};
  canvas.ondblclick=()=>{view(low,high);draw()};
  canvas.addEventListener('wheel',e=>{e.preventDefault();const x=time(e),f=Math.exp(e.deltaY*.0015);view(x-(x-a)*f,x+(b-x)*f);draw()},{passive:false})}}
function view(x,y){const w=Math.min(high-low,Math.max(y-x,(high-low)*1e-7));x=Math.min(Math.max(x,low),high-w);a=x;b=x+w}
function draw(){for(const q of panels)paint(q)}
function paint({p,canvas}){const r=devicePixelRatio||1,W=canvas.clientWidth,H=D.height+T+B;
 if(canvas.width!=Math.round(W*r)||canvas.height!=Math.round(H*r)){canvas.width=Math.round(W*r);canvas.height=Math.round(H*r)}
 const g=canvas.getContext('2d');g.setTransform(r,0,0,r,0,0);g.clearRect(0,0,W,H);g.font='12px sans-serif';
 const w=W-L-R,px=x=>L+(x-a)/(b-a)*w;let lo=Infinity,hi=-Infinity;
 for(const c of p.curves){if(c.hidden)continue;const{t,cuts}=axes[c.t];
  for(let k=0;k+1<cuts.length;k++){if(cuts[k]>=cuts[k+1])continue;
   for(let i=Math.max(cuts[k],last(t,a,cuts[k],cuts[k+1]));i<cuts[k+1];i++){const v=c.v[i];if(v!=null){if(v<lo)lo=v;if(v>hi)hi=v}if(t[i]>b)break}}}
 if(lo>hi){lo=0;hi=1}if(lo==hi){const m=Math.abs(lo)*.05||.5;lo-=m;hi+=m}const m=.06*(hi-lo);lo-=m;hi+=m;
 const py=v=>T+(hi-v)/(hi-lo)*D.height;
 g.lineWidth=1;g.strokeStyle='#e4e4e4';g.fillStyle='#444';g.textAlign='center';g.beginPath();
 for(const x of ticks(a,b,w/95)){g.moveTo(px(x),T);g.lineTo(px(x),T+D.height);g.fillText(x+' s',px(x),H-6)}
 g.textAlign='right';for(const v of ticks(lo,hi,D.height/38)){g.moveTo(L,py(v));g.lineTo(W-R,py(v));g.fillText(+v.toPrecision(6),L-6,py(v)+4)}
 g.stroke();g.save();g.beginPath();g.rect(L,T,w,D.height);g.clip();
 for(const c of p.curves)if(!c.hidden)line(g,c,px,py,w);
 if(drag&&!drag.moves){g.fillStyle='rgba(31,111,180,.15)';g.fillRect(px(Math.min(drag.at,drag.to)),T,Math.abs(px(drag.to)-px(drag.at)),D.height)}
 g.restore();g.strokeStyle='#999';g.strokeRect(L,T,w,D.height);
 if(pointer!=null&&pointer>=a&&pointer<=b){g.strokeStyle='#333';g.setLineDash([3,3]);g.beginPath();g.moveTo(px(pointer),T);g.lineTo(px(pointer),T+D.height);g.stroke();g.setLineDash([])}
 for(const c of p.curves){const i=pointer==null?-1:sample(axes[c.t],pointer);
  c.value.textContent=i<0?'':digits(c.v[i])+' at '+(+axes[c.t].t[i].toPrecision(9))+' s';
  if(i>=0&&!c.hidden&&c.v[i]!=null&&axes[c.t].t[i]>=a){g.fillStyle=c.colour;g.beginPath();g.arc(px(axes[c.t].t[i]),py(c.v[i]),3.5,0,7);g.fill()}}}
function line(g,c,px,py,w){const{t,cuts}=axes[c.t];g.strokeStyle=c.colour;g.lineWidth=1.4;g.setLineDash(c.dash);
 for(let k=0;k+1<cuts.length;k++){const s=cuts[k],e=cuts[k+1];if(s>=e||t[s]>b||t[e-1]<a)continue;
  const from=Math.max(s,last(t,a,s,e)),to=Math.min(e-1,last(t,b,s,e)+1),wide=to-from>3*w;let open=false,column=NaN,least=0,most=0,end=0;
  const put=(x,v)=>{open?g.lineTo(x,py(v)):g.moveTo(x,py(v));open=true},flush=()=>{if(!isNaN(column)){put(column,least);put(column,most);put(column,end);column=NaN}};
  g.beginPath();for(let i=from;i<=to;i++){const v=c.v[i];if(v==null){flush();open=false;continue}const x=px(t[i]);
   if(!wide){put(x,v);continue}const n=Math.round(x);
   if(n!=column){flush();put(n,v);column=n;least=most=end=v}else{least=Math.min(least,v);most=Math.max(most,v);end=v}}
  flush();g.stroke()}g.setLineDash([])}
addEventListener('resize',draw);draw();
)";

class Data {
 public:
  std::string write(std::span<const Plot> plots, double height) {
    std::string plots_text;
    for (const Plot& plot : plots) {
      plots_text += fmt::format("{}{{\"title\":{},\"panels\":[{}]}}", plots_text.empty() ? "" : ",",
                                json_string(plot.title), panels(plot));
    }
    std::string times_text;
    for (const std::vector<double>* times : times_) times_text += (times_text.empty() ? "" : ",") + numbers(*times, 12);
    std::string colours;
    for (const std::string_view colour : kColours) colours += (colours.empty() ? "" : ",") + json_string(colour);
    return fmt::format("{{\"colours\":[{}],\"height\":{},\"times\":[{}],\"plots\":[{}]}}", colours, height, times_text,
                       plots_text);
  }

 private:
  static std::string numbers(const std::vector<double>& values, int digits) {
    std::string text = "[";
    for (const double value : values) {
      if (text.size() > 1) text += ',';
      if (std::isfinite(value)) {
        fmt::format_to(std::back_inserter(text), "{:.{}g}", value, digits);
      } else {
        text += "null";
      }
    }
    return text + "]";
  }

  // variables of one node share their instants
  std::size_t axis(const std::vector<double>& time) {
    const auto same = std::find_if(times_.begin(), times_.end(),
                                   [&time](const std::vector<double>* known) { return *known == time; });
    if (same != times_.end()) return static_cast<std::size_t>(same - times_.begin());
    times_.push_back(&time);
    return times_.size() - 1;
  }

  // the same panels as in a picture
  std::string panels(const Plot& plot) {
    std::vector<std::string> units;  // in the order in which they first appear
    for (const Series& series : plot.series) {
      if (std::find(units.begin(), units.end(), series.unit) == units.end()) units.push_back(series.unit);
    }
    std::string text;
    for (const std::string& unit : units) {
      std::size_t count = 0;
      std::string curves;
      const auto end_panel = [&] {
        text += fmt::format("{}{{\"unit\":{},\"curves\":[{}]}}", text.empty() ? "" : ",", json_string(unit), curves);
        curves.clear();
        count = 0;
      };
      for (const Series& series : plot.series) {
        if (series.unit != unit) continue;
        if (count == kMaxCurvesOfPanel) end_panel();
        curves += fmt::format("{}{{\"name\":{},\"t\":{},\"v\":{}}}", count++ == 0 ? "" : ",", json_string(series.name),
                              axis(series.time), numbers(series.values, 7));
      }
      end_panel();
    }
    return text;
  }

  std::vector<const std::vector<double>*> times_;
};

}  // namespace

std::string plot_html(std::span<const Plot> plots, const PlotOptions& options) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>{1}</style>\n"
      "</head>\n<body>\n<h1>{0}</h1>\n<p class=\"sub\">{2}</p>\n<p class=\"sub\">wheel or drag: zoom; shift and drag: "
      "move; double click: all; click on a name: hide</p>\n<script type=\"application/json\" "
      "id=\"data\">{3}</script>\n<script>{4}</script>\n</body>\n</html>\n",
      escaped(options.title), kPageStyle, escaped(options.subtitle),
      in_script(Data().write(plots, std::max(options.panel_height, 60.0))), kPageScript);
}

std::string in_script(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) text.replace(at, 2, "<\\/");
  return text;
}

std::string json_string(std::string_view text) {
  return Json(text).dump();
}

std::string problem_of_picture_name(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (path == "-" || path.starts_with("/dev/") || ending == ".svg" || ending == ".html") return "";
  return "'" + path + "' ends neither in .svg nor in .html, the formats of pictures and pages; another program makes " +
         "others of an .svg, such as rsvg-convert a .png";
}

}  // namespace slew::plotting
