/** Stands in for a module that is still being built, in the page that `npm run build:early` makes: whoever loads it is told so. */
export default () =>
  Promise.reject({
    code: "module.building",
    message: "This part of the page is still being built: see the terminal. Load the page again when it is done.",
    path: null,
  });
