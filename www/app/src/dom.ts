/** The few things needed of the DOM. Text only ever becomes text nodes: names in files are hostile. */

/** The one element that `selector` finds inside `root`. */
export function find<E extends Element = HTMLElement>(selector: string, root: ParentNode = document): E {
  const element = root.querySelector<E>(selector);
  if (!element) {
    throw new Error(`The page has no ${selector}`);
  }
  return element;
}

/** A new element with attributes and children; strings become text. */
export function h<K extends keyof HTMLElementTagNameMap>(
  name: K,
  attributes: Record<string, string> = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

/** A copy of what a <template> holds. */
export function instantiate(selector: string): DocumentFragment {
  return find<HTMLTemplateElement>(selector).content.cloneNode(true) as DocumentFragment;
}

export function button(label: string, onClick: () => void, className = ""): HTMLButtonElement {
  const element = h("button", { type: "button", class: className }, label);
  element.addEventListener("click", onClick);
  return element;
}

/** Says something to screen readers, after what they are saying now. */
export function announce(text: string): void {
  find("#announcer").textContent = text;
}

/** Says what is wrong with a field, beside it and to screen readers; `null` takes it back. */
export function setProblem(field: HTMLInputElement, problem: string | null): void {
  find(`#${field.id}-error`).textContent = problem ?? "";
  field.setAttribute("aria-invalid", String(problem !== null));
}
