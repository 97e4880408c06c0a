// SPDX-License-Identifier: Apache-2.0
#include "analysis/tradeoff/tradeoff_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/display.h"
#include "core/escaped.h"
#include "core/json.h"
#include "core/report_table.h"
#include "plotting/html_plot.h"

namespace slew::analysis {
namespace {

std::string share(std::optional<double> value) {
  return value && std::isfinite(*value) ? fmt::format("{:.2g} %", 100 * *value) : "-";
}

std::string short_number(std::optional<double> value) {
  if (!value || !std::isfinite(*value)) return "-";
  return *value == 0 ? "0" : fmt::format("{:.1e}", *value);
}

std::string mark_of(const Tradeoff& tradeoff, std::size_t row) {
  std::string mark = row == 0 ? "now" : "";
  if (tradeoff.rows[row].is_pareto) mark += mark.empty() ? "best" : ", best";
  return mark;
}

Json json_number(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

std::vector<ReportCell> cells_of(const Tradeoff& tradeoff, std::size_t index) {
  const TradeoffRow& row = tradeoff.rows[index];
  const RowResult& result = row.result;
  std::vector<ReportCell> cells = {mark_of(tradeoff, index), text_of(row.settings)};
  for (const Axis& axis : tradeoff.axes) {
    const auto at = std::find_if(row.settings.begin(), row.settings.end(),
                                 [&](const auto& setting) { return setting.first == axis.path; });
    cells.emplace_back(at == row.settings.end() ? "" : at->second);
  }
  const bool has_figures = row.has_run() && result.failure.empty();
  const auto add = [&](std::string text, std::optional<double> exact) {
    cells.push_back(has_figures ? ReportCell(std::move(text), json_number(exact)) : ReportCell("-", {}));
  };
  for (std::size_t v = 0; v < tradeoff.variables.size(); ++v) {
    const std::optional<VariableError> error = v < result.errors.size() ? result.errors[v] : std::nullopt;
    add(share(relative_error(tradeoff, row, v, ErrorKind::largest)),
        error ? std::optional(error->largest) : std::nullopt);
    add(share(relative_error(tradeoff, row, v, ErrorKind::rms)), error ? std::optional(error->rms) : std::nullopt);
  }
  const std::optional<double> worst = worst_error(tradeoff, row);
  add(share(worst), worst);
  for (const std::optional<double>& defect : {result.eta, result.net, std::optional(result.gap)}) {
    add(short_number(defect), defect);
  }
  for (const double microseconds : {result.cost.median, result.cost.mean, result.cost.worst}) {
    add(fmt::format("{:.3g}", microseconds), microseconds);
  }
  cells.emplace_back("", row.is_pareto ? 1 : 0);
  cells.emplace_back(verdict(row));
  return cells;
}

// the text has the settings in one column, and only variables with a range: for the others no relative error exists
ReportTable table_of(const Tradeoff& tradeoff) {
  constexpr std::size_t kNaming = 2;  // mark, settings
  std::vector<ReportColumn> columns = {{.text = ""}, {.text = "settings"}};
  for (const Axis& axis : tradeoff.axes) columns.push_back({.csv = axis.path});
  for (const TradeoffVariable& variable : tradeoff.variables) {
    ReportColumn largest{.csv = fmt::format("{} largest error [{}]", variable.name, variable.unit)};
    ReportColumn rms{.csv = fmt::format("{} RMS error [{}]", variable.name, variable.unit)};
    if (variable.is_compared()) {
      largest.text = variable.name;
      rms.text = "RMS";
    }
    columns.push_back(std::move(largest));
    columns.push_back(std::move(rms));
  }
  columns.push_back({.csv = "worst error [1]"});
  columns.push_back({"eta", "eta [1]"});
  columns.push_back({"net", "net [1]"});
  columns.push_back({"joints", "joints open [m or rad]"});
  columns.push_back({"us/ms", "median [us/ms]"});
  columns.push_back({.csv = "mean [us/ms]"});
  columns.push_back({"worst", "worst step [us/ms]"});
  columns.push_back({.csv = "Pareto"});
  columns.push_back({"stable", "stable"});
  ReportTable table(std::move(columns), kNaming);
  for (std::size_t i = 0; i < tradeoff.rows.size(); ++i) {
    if (tradeoff.rows[i].is_done) table.add(cells_of(tradeoff, i));
  }
  return table;
}

Json json_of(const Tradeoff& tradeoff, const TradeoffRow& row) {
  Json settings = Json::object();
  for (const auto& [path, value] : row.settings) settings[path] = value;
  Json json = {{"settings", settings},          {"label", text_of(row.settings)}, {"is_done", row.is_done},
               {"is_stable", row.is_stable()},  {"is_pareto", row.is_pareto},     {"verdict", verdict(row)},
               {"refusal", row.result.refusal}, {"failure", row.result.failure}};
  if (!row.has_run() || !row.result.failure.empty()) return json;
  const RowResult& result = row.result;
  json["errors"] = Json::object();
  for (std::size_t v = 0; v < tradeoff.variables.size(); ++v) {
    if (v >= result.errors.size() || !result.errors[v]) continue;
    json["errors"][tradeoff.variables[v].name] = {
        {"largest", json_number(result.errors[v]->largest)},
        {"rms", json_number(result.errors[v]->rms)},
        {"relative", json_number(relative_error(tradeoff, row, v))},
        {"relative_rms", json_number(relative_error(tradeoff, row, v, ErrorKind::rms))}};
  }
  json["worst_error"] = json_number(worst_error(tradeoff, row));
  json["worst_rms"] = json_number(worst_error(tradeoff, row, ErrorKind::rms));
  json["eta_max"] = json_number(result.eta);
  json["net_min"] = json_number(result.net);
  json["joint_gap"] = result.gap;
  json["not_converged"] = result.not_converged;
  json["us_per_ms"] = {{"median", result.cost.median}, {"mean", result.cost.mean}, {"worst_step", result.cost.worst}};
  return json;
}

Json to_json(const Tradeoff& tradeoff, const std::optional<Answer>& answer) {
  Json json = {{"scene", tradeoff.scene},    {"file", tradeoff.file},
               {"until", tradeoff.until},    {"reference", tradeoff.reference},
               {"folder", tradeoff.folder},  {"is_complete", tradeoff.is_complete()},
               {"kept", tradeoff.kept},      {"axes", Json::array()},
               {"variables", Json::array()}, {"rows", Json::array()}};
  for (const Axis& axis : tradeoff.axes) json["axes"].push_back({{"path", axis.path}, {"values", axis.values}});
  for (const TradeoffVariable& variable : tradeoff.variables) {
    json["variables"].push_back({{"name", variable.name},
                                 {"unit", variable.unit},
                                 {"range", variable.range},
                                 {"spread", json_number(variable.spread)},
                                 {"is_at_rest", variable.is_at_rest}});
  }
  for (const TradeoffRow& row : tradeoff.rows) json["rows"].push_back(json_of(tradeoff, row));
  if (answer) {
    json["answer"] = {{"text", answer_text(tradeoff, *answer)},
                      {"row", answer->row ? Json(*answer->row) : Json()},
                      {"overlay", answer->overlay}};
  }
  return json;
}

std::string variables_text(const Tradeoff& tradeoff) {
  std::string text;
  for (const TradeoffVariable& variable : tradeoff.variables) {
    if (!(variable.range > 0)) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", variable.name,
                        quantity_text(variable.range, variable.unit, variable.name));
    if (variable.is_at_rest) {
      text += " (at rest, no error)";
    } else if (variable.spread)
      text += fmt::format(" (own error {})", share(*variable.spread / variable.range));
  }
  return text;
}

constexpr std::string_view kTradeoffStyle = R"(
body{font-family:sans-serif;margin:1.5em;color:#222}
svg{background:#fff;border:1px solid #ccc;width:100%;max-width:1000px;height:auto}
#tip{position:fixed;pointer-events:none;background:#222;color:#fff;padding:.5em .7em;border-radius:4px;font-size:13px;
 white-space:pre;display:none;z-index:2}
table{border-collapse:collapse;font-size:13px;margin-top:1em}
td,th{padding:.2em .6em;text-align:right;border-bottom:1px solid #ddd;white-space:nowrap}
td:nth-child(2),td:last-child,th:nth-child(2),th:last-child,td:first-child{text-align:left}
th{cursor:pointer;position:sticky;top:0;background:#f4f4f4}
tr.now{font-weight:bold}tr.best td:first-child{color:#0a6}tr.chosen{background:#fff3c4}tr.hot{background:#e8f1ff}
select,label{font-size:14px;margin-right:1em}
)";

// the figure and the table are drawn from the data, so that variable and kind of error can be chosen
constexpr std::string_view kTradeoffScript = R"(
const D=JSON.parse(document.getElementById('data').textContent),S='http://www.w3.org/2000/svg';
const pick=document.getElementById('variable'),kind=document.getElementById('kind'),tip=document.getElementById('tip');
const names=['worst of all',...D.variables.filter(v=>v.range>0&&!v.is_at_rest).map(v=>v.name)];
names.forEach((n,i)=>pick.add(new Option(n,i)));
const error=r=>{if(!r.us_per_ms)return null;const rms=kind.value=='rms';
 if(pick.value==0)return rms?r.worst_rms:r.worst_error;
 const e=r.errors[names[pick.value]];return e?(rms?e.relative_rms:e.relative):null};
const colours=['#1f6fb4','#d4620f','#2a8f3c','#a03bb0','#b8262b','#6b5b3e','#3a9aa0'];
const path=D.axes.map(a=>a.path).find(p=>p=='session.coupling')||(D.axes[0]||{path:''}).path;
const groups=[...new Set(D.rows.map(r=>r.settings[path]||'as the scene'))];
const colour=r=>colours[groups.indexOf(r.settings[path]||'as the scene')%colours.length];
const el=(n,a,t)=>{const e=document.createElementNS(S,n);for(const k in a)e.setAttribute(k,a[k]);if(t!=null)e.textContent=t;return e};
const pc=x=>x==null?'-':(100*x).toPrecision(2)+' %';
function text(r,i){let t=(i==0?'the scene as it is\n':'')+(r.is_pareto?'on the Pareto front\n':'');
 for(const k in r.settings)t+=k+' = '+r.settings[k]+'\n';
 if(r.us_per_ms)t+='\n'+r.us_per_ms.median.toPrecision(3)+' \u00b5s per ms, worst step '+r.us_per_ms.worst_step.toPrecision(3)+'\n'+
  names.slice(1).map(n=>n+': '+(r.errors[n]?pc(r.errors[n].relative)+', RMS '+pc(r.errors[n].relative_rms):'-')).join('\n')+
  (r.eta_max!=null?'\neta '+r.eta_max.toExponential(1)+', net '+r.net_min.toExponential(1):'');
 return t+'\nstable: '+r.verdict}
function show(e,r,i){tip.textContent=text(r,i);tip.style.display='block';
 tip.style.left=Math.min(e.clientX+14,innerWidth-tip.offsetWidth-8)+'px';
 tip.style.top=Math.min(e.clientY+14,innerHeight-tip.offsetHeight-8)+'px';hot(i,true)}
function hide(i){tip.style.display='none';hot(i,false)}
const hot=(i,on)=>{const t=document.getElementById('row'+i);if(t)t.classList.toggle('hot',on)};
function draw(){const W=1000,H=560,L=80,R=20,T=30,B=60,svg=document.getElementById('plot');svg.replaceChildren();
 const P=D.rows.map((r,i)=>({r,i,x:r.us_per_ms&&r.us_per_ms.median,y:error(r)})).filter(p=>p.x>0&&p.y>0&&p.r.is_stable);
 if(!P.length){svg.append(el('text',{x:W/2,y:H/2,'text-anchor':'middle'},'no stable row'));return}
 const span=f=>{let a=Math.log10(Math.min(...P.map(f))),b=Math.log10(Math.max(...P.map(f)));const m=.05*(b-a)+.08;return[a-m,b+m]};
 const X=span(p=>p.x),Y=span(p=>p.y),px=x=>L+(Math.log10(x)-X[0])/(X[1]-X[0])*(W-L-R),py=y=>H-B-(Math.log10(y)-Y[0])/(Y[1]-Y[0])*(H-T-B);
 const grid=(S2,f,g)=>{const w=S2[1]-S2[0];for(let d=Math.floor(S2[0]);d<=S2[1];d++)for(const m of w>2.2?[1]:w>.7?[1,2,5]:[1,2,3,4,5,6,7,8,9]){const v=m*10**d,l=Math.log10(v);if(l>=S2[0]&&l<=S2[1])g(v)}};
 grid(X,px,v=>{svg.append(el('line',{x1:px(v),x2:px(v),y1:T,y2:H-B,stroke:'#e4e4e4'}),el('text',{x:px(v),y:H-B+18,'text-anchor':'middle','font-size':13},+v.toPrecision(2)))});
 grid(Y,py,v=>{svg.append(el('line',{x1:L,x2:W-R,y1:py(v),y2:py(v),stroke:'#e4e4e4'}),el('text',{x:L-8,y:py(v)+4,'text-anchor':'end','font-size':13},+(100*v).toPrecision(2)+' %'))});
 svg.append(el('text',{x:(L+W-R)/2,y:H-14,'text-anchor':'middle','font-size':14},'microseconds per simulated millisecond (median step)'));
 svg.append(el('text',{x:18,y:(T+H-B)/2,'text-anchor':'middle','font-size':14,transform:`rotate(-90 18 ${(T+H-B)/2})`},(kind.value=='rms'?'RMS':'largest')+' error, share of range: '+names[pick.value]));
 let best=[],least=Infinity;for(const p of [...P].sort((a,b)=>a.x-b.x||a.y-b.y))if(p.y<least){least=p.y;best.push(p)}
 svg.append(el('polyline',{points:best.map(p=>px(p.x)+','+py(p.y)).join(' '),fill:'none',stroke:'#0a6','stroke-width':2,'stroke-dasharray':'6 4'}));
 for(const p of P){const on=best.includes(p),c=el('circle',{cx:px(p.x),cy:py(p.y),r:on?6.5:5,fill:colour(p.r),stroke:on?'#0a6':'#fff','stroke-width':on?2.5:1});
  c.onmousemove=e=>show(e,p.r,p.i);c.onmouseleave=()=>hide(p.i);
  c.onclick=()=>document.getElementById('row'+p.i).scrollIntoView({block:'center'});svg.append(c);
  if(p.i==0)svg.append(el('circle',{cx:px(p.x),cy:py(p.y),r:12,fill:'none',stroke:'#222','stroke-width':2,'pointer-events':'none'}),el('text',{x:px(p.x)+16,y:py(p.y)-10,'font-size':13,'font-weight':'bold'},'now'));
  if(D.answer&&D.answer.row==p.i)svg.append(el('rect',{x:px(p.x)-14,y:py(p.y)-14,width:28,height:28,fill:'none',stroke:'#d90','stroke-width':2.5,'pointer-events':'none'}),el('text',{x:px(p.x)-14,y:py(p.y)+29,'font-size':13,'font-weight':'bold',fill:'#a60'},'answer'))}
 const shown=groups.filter(g=>P.some(p=>(p.r.settings[path]||'as the scene')==g)),n=shown.length;
 shown.forEach((g,k)=>svg.append(el('circle',{cx:W-R-170,cy:T+14+k*18,r:5,fill:colours[groups.indexOf(g)%colours.length]}),el('text',{x:W-R-158,y:T+18+k*18,'font-size':13},path.split('.').pop()+' '+g)));
 svg.append(el('line',{x1:W-R-176,x2:W-R-164,y1:T+14+n*18,y2:T+14+n*18,stroke:'#0a6','stroke-width':2}),el('text',{x:W-R-158,y:T+18+n*18,'font-size':13},'Pareto front'))}
let order=null,up=true;
function table(){const head=['','settings',...names.slice(1),'eta','net','joints','\u00b5s/ms','worst step','stable'];
 const cell=(r,i)=>[(i==0?'now':'')+(r.is_pareto?' best':''),r.label,...names.slice(1).map(n=>r.errors&&r.errors[n]?(kind.value=='rms'?r.errors[n].relative_rms:r.errors[n].relative):null),
  r.eta_max,r.net_min,r.joint_gap,r.us_per_ms&&r.us_per_ms.median,r.us_per_ms&&r.us_per_ms.worst_step,r.verdict];
 const n=names.length-1,form=(v,k)=>v==null?'-':typeof v=='string'?v:k>=2&&k<2+n?pc(v):k<5+n?v.toExponential(1):v.toPrecision(3);
 let rows=D.rows.map((r,i)=>({r,i,c:cell(r,i)}));
 if(order!=null)rows.sort((a,b)=>{const x=a.c[order],y=b.c[order];if(x==null)return 1;if(y==null)return -1;return(x<y?-1:x>y?1:0)*(up?1:-1)});
 const t=document.getElementById('rows');t.replaceChildren();const h=t.insertRow();
 head.forEach((x,k)=>{const c=document.createElement('th');c.textContent=x;c.onclick=()=>{up=order==k?!up:true;order=k;table()};h.append(c)});
 for(const{r,i,c}of rows){const w=t.insertRow();w.id='row'+i;w.className=(i==0?'now ':'')+(r.is_pareto?'best ':'')+(D.answer&&D.answer.row==i?'chosen':'');
  c.forEach((v,k)=>w.insertCell().textContent=form(v,k))}}
pick.onchange=draw;kind.onchange=()=>{draw();table()};draw();table();
)";

}  // namespace

std::string answer_text(const Tradeoff& tradeoff, const Answer& answer) {
  std::string limits;
  const auto add = [&limits](const std::string& part) { limits += (limits.empty() ? "" : ", ") + part; };
  if (answer.question.budget) add(fmt::format("at most {:g} us/ms", *answer.question.budget));
  for (const ErrorBound& bound : answer.question.errors) add(bound.text);
  if (!answer.row) return limits + ": no stable row meets this";
  const TradeoffRow& row = tradeoff.rows[*answer.row];
  return fmt::format("{}: {} ({:.3g} us/ms, worst error {})", limits,
                     *answer.row == 0 ? "the scene as it is" : text_of(row.settings), row.result.cost.median,
                     share(worst_error(tradeoff, row)));
}

std::string report_text(const Tradeoff& tradeoff, const std::optional<Answer>& answer, std::size_t width) {
  std::string text;
  const auto line = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<12}{}\n", name, value);
  };
  line("scene", fmt::format("{}, {:.6g} s", tradeoff.scene, tradeoff.until));
  if (!tradeoff.reference.empty()) line("reference", tradeoff.reference);
  line("range", variables_text(tradeoff));
  line("error", "largest and root mean square, share of the range");
  line("us/ms", "microseconds of all physics in one process for a simulated millisecond: median step, worst step");
  text += '\n';
  text += table_of(tradeoff).text("", width);
  if (!tradeoff.is_complete()) {
    text += fmt::format("interrupted: {} of {} rows; the same command goes on from {}\n", tradeoff.done(),
                        tradeoff.rows.size(), tradeoff.folder);
  }
  if (answer) text += answer_text(tradeoff, *answer) + '\n';
  return text;
}

std::string report_json(const Tradeoff& tradeoff, const std::optional<Answer>& answer) {
  return to_json(tradeoff, answer).dump(2);
}

std::string report_csv(const Tradeoff& tradeoff) {
  return table_of(tradeoff).csv();
}

std::string report_html(const Tradeoff& tradeoff, const std::optional<Answer>& answer) {
  std::string note = fmt::format("{:.6g} s; reference: {}", tradeoff.until, tradeoff.reference);
  if (answer) note += ". " + answer_text(tradeoff, *answer);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{0}: error against cost</title>\n"
      "<style>{1}</style></head>\n<body>\n<h2>{0}: error against cost</h2>\n<p>{2}</p>\n"
      "<p><label>error of <select id=\"variable\"></select></label>"
      "<label><select id=\"kind\"><option value=\"largest\">largest</option><option value=\"rms\">RMS</option></select>"
      "</label></p>\n<svg id=\"plot\" viewBox=\"0 0 1000 560\"></svg>\n<div id=\"tip\"></div>\n"
      "<table id=\"rows\"></table>\n<script id=\"data\" type=\"application/json\">{3}</script>\n"
      "<script>{4}</script>\n</body>\n</html>\n",
      escaped(tradeoff.scene), kTradeoffStyle, escaped(note), plotting::in_script(to_json(tradeoff, answer).dump()),
      kTradeoffScript);
}

}  // namespace slew::analysis
