// SPDX-License-Identifier: Apache-2.0
// Runs the script of a page without a browser: as much of the DOM as the pages of `plot` and `animate` use.
//
//   node page_stub.js PAGE.html DRIVER.js
//
// The driver runs in the page's own scope, so it sees the page's functions and variables, and `page`: what is on it. Its
// function drive() gives what is printed, as JSON.
'use strict';
const fs = require('fs'), vm = require('vm');
const html = fs.readFileSync(process.argv[2], 'utf8');

// every line that is drawn, as points in px, with what it was drawn with; cleared as a canvas is
class Context {
  constructor() { this.clear(); }
  clear() { this.lines = []; this.texts = []; this.current = []; this.globalAlpha = 1; }
  clearRect() { this.clear(); }
  beginPath() { this.current = []; }
  moveTo(x, y) { this.current.push([[x, y]]); }
  lineTo(x, y) { this.current[this.current.length - 1].push([x, y]); }
  stroke() {
    for (const points of this.current) {
      this.lines.push({points, colour: this.strokeStyle, width: this.lineWidth, alpha: this.globalAlpha});
    }
  }
  fillText(text, x, y) { this.texts.push({text: String(text), x, y}); }
  setTransform() {} save() {} restore() {} rect() {} clip() {} fillRect() {} strokeRect() {} setLineDash() {}
  arc() {} fill() {}
}

class Element {
  constructor(tag) {
    this.tag = tag; this.style = {}; this.children = []; this.listeners = {}; this.textContent = ''; this.className = '';
    this.clientWidth = 800; this.clientHeight = 600; this.context = new Context();
  }
  append(...parts) { this.children.push(...parts); }
  addEventListener(name, listener) { this.listeners[name] = listener; }
  getContext() { return this.context; }
  setPointerCapture() {}
  set width(w) { this.ownWidth = w; this.context.clear(); }
  get width() { return this.ownWidth; }
}

const page = {elements: {}, frames: [], now: 0, created: []};
for (const [, tag, id] of html.matchAll(/<(\w+)[^>]*\bid="(\w+)"/g)) page.elements[id] = new Element(tag);
for (const [, id, value] of html.matchAll(/<input id="(\w+)"[^>]*\bvalue="([^"]*)"/g)) page.elements[id].value = value;
for (const [, id, value] of html.matchAll(/<select id="(\w+)".*?selected>([^<]*)</g)) page.elements[id].value = value;
const scripts = [...html.matchAll(/<script([^>]*)>([\s\S]*?)<\/script>/g)];
page.elements.data.textContent = scripts.find(([, kind]) => kind.includes('json'))[2];

const context = vm.createContext({
  page,
  document: {
    getElementById: id => page.elements[id],
    createElement: tag => { const made = new Element(tag); page.created.push(made); return made; },
    body: new Element('body'),
  },
  devicePixelRatio: 1,
  addEventListener() {},
  performance: {now: () => page.now},
  requestAnimationFrame: frame => page.frames.push(frame),
});
vm.runInContext(scripts.find(([, kind]) => kind === '')[2], context);
vm.runInContext(fs.readFileSync(process.argv[3], 'utf8'), context);
process.stdout.write(JSON.stringify(vm.runInContext('drive()', context)));
