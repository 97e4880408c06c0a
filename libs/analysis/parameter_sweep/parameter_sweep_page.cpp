// SPDX-License-Identifier: Apache-2.0
// The page of a parameter sweep: data, style and the script that draws them, in one file.
#include <fmt/format.h>

#include <string_view>

#include "analysis/parameter_sweep/parameter_sweep.h"
#include "core/escaped.h"
#include "plotting/html_plot.h"

namespace slew::analysis {
namespace {

constexpr std::string_view kSweepStyle = R"(
:root{color-scheme:light dark;--ground:#fff;--text:#1d2227;--quiet:#5d656e;--line:#d5dade;--grid:#eceff1;--bad:#b8262b;
 --hot:#e8f1ff;--faint:.12}
@media (prefers-color-scheme:dark){:root{--ground:#15181b;--text:#e4e7ea;--quiet:#9aa3ab;--line:#3a4148;--grid:#262b30;
 --bad:#ff7b72;--hot:#1f3350;--faint:.16}}
body{font-family:Inter,'Helvetica Neue',Arial,'DejaVu Sans',sans-serif;margin:1.5em;color:var(--text);
 background:var(--ground);font-size:14px}
h1{font-size:20px;margin:0}p{color:var(--quiet);margin:.3em 0 1em}h2{font-size:15px;margin:1.4em 0 .3em}
svg{width:100%;max-width:1100px;height:auto;display:block}svg text{fill:var(--text);font-size:12px}
svg text.quiet{fill:var(--quiet);paint-order:stroke;stroke:var(--ground);stroke-width:4px}svg line{stroke:var(--grid)}svg line.axis{stroke:var(--line)}
.row{fill:none;stroke-width:1.2;opacity:.65}.row.off{opacity:var(--faint)}.row.hot{stroke-width:3;opacity:1}
.dot.off{opacity:var(--faint)}.dot.hot{stroke:var(--text);stroke-width:2}
.brush{fill:var(--text);fill-opacity:.12;stroke:var(--quiet)}.grab{fill:transparent;cursor:ns-resize}
.scroll{overflow-x:auto;max-height:32em;overflow-y:auto}
table{border-collapse:collapse;font-size:13px}td,th{padding:.2em .7em;text-align:right;white-space:nowrap;
 border-bottom:1px solid var(--line)}th{cursor:pointer;position:sticky;top:0;background:var(--ground)}
td:last-child,th:last-child{text-align:left}tr.bad td:last-child{color:var(--bad)}tr.hot{background:var(--hot)}
label{margin-right:1.2em;color:var(--quiet)}
)";

// Columns: varied values, then measures; a column of words has its words as places. Axes are brushed by dragging; rows
// outside of a brush fade in all three views.
constexpr std::string_view kSweepScript = R"(
const D=JSON.parse(document.getElementById('data').textContent),S='http://www.w3.org/2000/svg';
const $=id=>document.getElementById(id),el=(n,a,t)=>{const e=document.createElementNS(S,n);for(const k in a)e.setAttribute(k,a[k]);
 if(t!=null)e.textContent=t;return e};
const R=D.rows.map((r,i)=>({...r,i})).filter(r=>r.is_done),nV=D.variations.length;
const C=[...D.variations.map((v,k)=>({name:v.path,unit:v.unit,of:r=>r.varied[k]})),
 ...D.measures.map((m,k)=>({name:m.text,unit:m.unit,of:r=>r.values[k]??null}))];
for(const c of C){const all=R.map(c.of).filter(v=>v!=null);c.words=all.some(v=>typeof v=='string')?[...new Set(all)]:null;
 c.number=r=>{const v=c.of(r);return v==null?null:c.words?c.words.indexOf(v):v};
 const n=R.map(c.number).filter(v=>v!=null);c.low=n.reduce((a,b)=>Math.min(a,b),Infinity);c.high=n.reduce((a,b)=>Math.max(a,b),-Infinity);
 if(!n.length){c.low=0;c.high=1}if(c.low==c.high){const d=Math.abs(c.low)*.1||1;c.low-=d;c.high+=d}c.brush=null}
const digits=x=>{const a=Math.abs(x);return a!=0&&(a>=1e5||a<1e-3)?(+x.toPrecision(5)).toExponential():String(+x.toPrecision(5))};
const show=(c,x)=>c.words?(c.words[Math.round(x)]??''):digits(x);
const title=c=>c.name+(c.unit?' ['+c.unit+']':'');
// five points of the map viridis, legible on light and dark ground without its ends
const stops=[[72,60,140],[49,104,142],[33,145,140],[73,193,109],[222,190,40]];
const shade=f=>{const p=Math.max(0,Math.min(.9999,f))*4,i=Math.floor(p),u=p-i;
 return'rgb('+stops[i].map((a,k)=>Math.round(a+(stops[i+1][k]-a)*u)).join(',')+')'};
const part=(c,r)=>{const x=c.number(r);return x==null?null:(x-c.low)/(c.high-c.low)};
const colour=r=>{const f=part(C[$('shade').value],r);return f==null?'var(--bad)':shade(f)};
const inside=r=>C.every(c=>{if(!c.brush)return true;const x=c.number(r);return x!=null&&x>=c.brush[0]&&x<=c.brush[1]});
C.forEach((c,k)=>{for(const id of['x','y','shade'])$(id).add(new Option(title(c),k))});
$('x').value=0;$('y').value=nV;$('shade').value=nV;
const hot=(i,on)=>document.querySelectorAll('[data-row="'+i+'"]').forEach(e=>e.classList.toggle('hot',on));
const link=(e,r)=>{e.dataset.row=r.i;e.onmouseenter=()=>hot(r.i,true);e.onmouseleave=()=>hot(r.i,false);return e};
const words=r=>'row '+r.i+'\n'+C.map(c=>c.name+' = '+(c.of(r)==null?'-':c.words?c.of(r):digits(c.of(r))+' '+c.unit)).join('\n');
function ticks(c,n){if(c.words)return c.words.map((w,i)=>i);const raw=(c.high-c.low)/n,p=10**Math.floor(Math.log10(raw)),
 s=[1,2,5,10].map(m=>m*p).find(m=>m>=raw),out=[];for(let v=Math.ceil(c.low/s);v*s<=c.high+1e-9*s;v++)out.push(v*s);return out}
function parallel(){const W=1100,H=380,T=56,B=24,L=60,svg=$('parallel'),step=(W-2*L)/Math.max(1,C.length-1);svg.replaceChildren();
 const X=k=>C.length>1?L+k*step:W/2,Y=f=>H-B-f*(H-T-B);
 for(const r of R){let d='',pen='M';C.forEach((c,k)=>{const f=part(c,r);if(f==null){pen='M';return}d+=pen+X(k).toFixed(1)+' '+Y(f).toFixed(1);pen='L'});
  const p=link(el('path',{class:'row',d,stroke:colour(r)}),r);p.append(el('title',{},words(r)));svg.append(p)}
 C.forEach((c,k)=>{svg.append(el('line',{class:'axis',x1:X(k),x2:X(k),y1:T,y2:H-B}));
  const isEdge=k==0||k==C.length-1,most=Math.floor(((C.length>1?isEdge?step/2+L:step:W)-10)/6.5),name=c.name.length>most?c.name.slice(0,most-1)+'\u2026':c.name,
   lines=[name,c.unit?'['+c.unit+']':''],at=k==0?'start':k==C.length-1?'end':'middle',x=k==0?X(k)-L+4:k==C.length-1?X(k)+L-4:X(k);
  lines.forEach((t,j)=>{const e=el('text',{x,y:T-30+14*j,'text-anchor':at},t);e.append(el('title',{},title(c)));if(j)e.setAttribute('class','quiet');svg.append(e)});
  for(const v of ticks(c,5)){const y=Y((v-c.low)/(c.high-c.low));svg.append(el('line',{class:'axis',x1:X(k)-4,x2:X(k),y1:y,y2:y}),
   el('text',{class:'quiet',x:X(k)-7,y:y+4,'text-anchor':'end'},show(c,v)))}
  if(c.brush)svg.append(el('rect',{class:'brush',x:X(k)-7,width:14,y:Y((c.brush[1]-c.low)/(c.high-c.low)),height:Math.max(2,Y((c.brush[0]-c.low)/(c.high-c.low))-Y((c.brush[1]-c.low)/(c.high-c.low)))}));
  const g=el('rect',{class:'grab',x:X(k)-12,y:T-6,width:24,height:H-T-B+12});
  g.onpointerdown=e=>{const value=e=>{const b=svg.getBoundingClientRect(),y=(e.clientY-b.top)*H/b.height;return c.low+(H-B-y)/(H-T-B)*(c.high-c.low)},from=value(e);
   const move=e=>{const to=value(e);c.brush=[Math.min(from,to),Math.max(from,to)];draw()},
    up=()=>{removeEventListener('pointermove',move);if(!c.brush||c.brush[1]-c.brush[0]<.01*(c.high-c.low))c.brush=null;draw()};
   addEventListener('pointermove',move);addEventListener('pointerup',up,{once:true})};svg.append(g)})}
function scatter(){const W=1100,H=430,L=100,Rm=24,T=16,B=52,svg=$('scatter'),cx=C[$('x').value],cy=C[$('y').value];svg.replaceChildren();
 const X=f=>L+(.03+.94*f)*(W-L-Rm),Y=f=>H-B-(.04+.92*f)*(H-T-B);
 for(const v of ticks(cx,8)){const x=X((v-cx.low)/(cx.high-cx.low));svg.append(el('line',{x1:x,x2:x,y1:T,y2:H-B}),el('text',{class:'quiet',x,y:H-B+18,'text-anchor':'middle'},show(cx,v)))}
 for(const v of ticks(cy,6)){const y=Y((v-cy.low)/(cy.high-cy.low));svg.append(el('line',{x1:L,x2:W-Rm,y1:y,y2:y}),el('text',{class:'quiet',x:L-8,y:y+4,'text-anchor':'end'},show(cy,v)))}
 svg.append(el('line',{class:'axis',x1:L,x2:L,y1:T,y2:H-B}),el('line',{class:'axis',x1:L,x2:W-Rm,y1:H-B,y2:H-B}),
  el('text',{x:(L+W-Rm)/2,y:H-10,'text-anchor':'middle'},title(cx)),el('text',{x:16,y:(T+H-B)/2,'text-anchor':'middle',transform:'rotate(-90 16 '+(T+H-B)/2+')'},title(cy)));
 for(const r of R){const fx=part(cx,r),fy=part(cy,r);if(fx==null||fy==null)continue;
  const d=link(el('circle',{class:'dot',cx:X(fx),cy:Y(fy),r:R.length>300?3:5,fill:colour(r)}),r);d.append(el('title',{},words(r)));svg.append(d)}}
let order=null,up=true;
function table(){const t=$('rows');t.replaceChildren();const h=t.insertRow();['row',...C.map(title),'result'].forEach((x,k)=>{
  const c=document.createElement('th');c.textContent=x;c.onclick=()=>{up=order==k?!up:true;order=k;draw()};h.append(c)});
 const result=r=>(r.code?'code '+r.code+': '+r.message:'ok')+(r.is_foreign?' (other build or processor)':'');
 const cell=(r,k)=>k==0?r.i:k<=C.length?C[k-1].number(r):result(r);
 let rows=[...R];if(order!=null)rows.sort((a,b)=>{const x=cell(a,order),y=cell(b,order);if(x==null)return 1;if(y==null)return-1;return(x<y?-1:x>y?1:0)*(up?1:-1)});
 for(const r of rows){if(!inside(r))continue;const w=link(t.insertRow(),r);if(r.code)w.className='bad';
  w.insertCell().textContent=r.i;for(const c of C){const v=c.of(r);w.insertCell().textContent=v==null?'-':c.words?v:digits(v)}
  w.insertCell().textContent=result(r)}}
function draw(){parallel();scatter();table();const off=new Set(R.filter(r=>!inside(r)).map(r=>String(r.i)));
 document.querySelectorAll('svg [data-row]').forEach(e=>e.classList.toggle('off',off.has(e.dataset.row)));
 $('count').textContent=off.size?(R.length-off.size)+' of '+R.length+' rows lie within the marked ranges; drag on an axis to change, click it to clear.':'Drag on an axis to mark a range.'}
for(const id of['x','y','shade'])$(id).onchange=draw;draw();
)";

}  // namespace

std::string report_html(const ParameterSweep& sweep) {
  const std::string name = escaped(sweep.scene);
  std::string about = fmt::format("{} of {} rows of {}, {}", sweep.done(), sweep.rows.size(), sweep.duration_text(),
                                  to_text(sweep.sampling));
  if (sweep.sampling != Sampling::grid) about += fmt::format(" with seed {}", sweep.seed);
  if (sweep.failed() > 0) about += fmt::format(", {} failed", sweep.failed());
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>Sweep of {0}</title><style>{1}</style></head><body>\n"
      "<h1>Sweep of {0}</h1><p>{2}</p>\n"
      "<label>colour <select id=\"shade\"></select></label><span id=\"count\"></span>\n"
      "<h2>All values of each row</h2><svg id=\"parallel\" viewBox=\"0 0 1100 380\"></svg>\n"
      "<h2>Two of them</h2><label>across <select id=\"x\"></select></label><label>up <select "
      "id=\"y\"></select></label>\n"
      "<svg id=\"scatter\" viewBox=\"0 0 1100 430\"></svg>\n"
      "<h2>Rows</h2><div class=\"scroll\"><table id=\"rows\"></table></div>\n"
      "<script type=\"application/json\" id=\"data\">{3}</script>\n<script>{4}</script></body></html>\n",
      name, kSweepStyle, escaped(about), plotting::in_script(report_json(sweep).dump()), kSweepScript);
}

}  // namespace slew::analysis
