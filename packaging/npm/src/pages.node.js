// The <img> of an HTML page, for the command that fills them in. A page is taken as latin1, one letter a byte, so that what is not touched
// stays as it is in any encoding in which ASCII is ASCII.

// Their content is text, or is seen only where scripts do not run: no tags are looked for in it.
const TEXTS = ['script', 'style', 'textarea', 'title', 'xmp', 'iframe', 'noembed', 'noframes', 'noscript'];

// Names of what addresses need, and numbers, as which mustache has every /.
const unescape = (text) => text.replace(/&(?:(amp|quot|lt|gt|apos)|#(\d{1,7}|x[\da-f]{1,6}));/gi, (whole, name, number) => {
  if (name) return { amp: '&', quot: '"', lt: '<', gt: '>', apos: "'" }[name] ?? whole;
  const code = Number(/^x/i.test(number) ? `0${number}` : number);
  return code <= 0x10ffff ? String.fromCodePoint(code) : whole;
});

// What letters of one byte each stand for: UTF-8, or where they are not, themselves.
function decode(letters) {
  try {
    return new TextDecoder('utf-8', { fatal: true }).decode(Buffer.from(letters, 'latin1'));
  } catch {
    return letters;
  }
}

// The tags that begin something: their names, their attributes (the first of a name counts), and where another attribute can be put, which
// is behind the name. What is white is what HTML calls so, and no letter of latin1.
export function* tagsOf(page) {
  // Comments, what is taken for one, such as <?xml?>, which ends with the next >, and tags.
  const tag = /<!--(?:-?>|[^]*?(?:--!?>|$))|<(?:[!?]|\/[^a-z>])[^>]*|<(\/?[a-z][^\t\n\f\r />]*)/gi;
  const attribute = /[\t\n\f\r /]*(?:(>)|([^\t\n\f\r />][^\t\n\f\r />=]*)(?:[\t\n\f\r ]*=[\t\n\f\r ]*("[^"]*"|'[^']*'|[^\t\n\f\r >"'][^\t\n\f\r >]*))?)/y;
  for (let begun; (begun = tag.exec(page));) {
    if (!begun[1]) continue;
    const name = begun[1].toLowerCase(), attributes = new Map(), at = attribute.lastIndex = tag.lastIndex;
    let found;
    while ((found = attribute.exec(page)) && !found[1]) {
      const [, , key, value = ''] = found, low = key.toLowerCase();
      if (!attributes.has(low)) attributes.set(low, unescape(decode(value.replace(/^(["'])([^]*)\1$/, '$2'))));
    }
    if (!found) return;  // the page ends within the tag
    tag.lastIndex = attribute.lastIndex;
    if (name.startsWith('/')) continue;
    yield { name, attributes, at };
    if (!TEXTS.includes(name)) continue;
    const end = new RegExp(`</${name}[\\t\\n\\f\\r />]`, 'gi');
    end.lastIndex = tag.lastIndex;
    if (end.exec(page)) tag.lastIndex = end.lastIndex;
    else if (page[tag.lastIndex - 2] !== '/') return;  // all that follows is its text, but of <title/> in SVG
  }
}
