// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarAdvise.h"
#include "AvianLidarErrors.h"
#include "AvianLidarInitializers.h"
#include "AvianLidarUndo.h"
#include "AvianLidarWizard.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqDataRepresentation.h"
#include "pqObjectBuilder.h"
#include "pqOutputPort.h"
#include "pqPVApplicationCore.h"
#include "pqPipelineSource.h"
#include "pqPropertiesPanel.h"
#if __has_include("pqProxyAction.h")
#include "pqProxyAction.h" // ParaView 5.13
#endif
#include "pqProxyGroupMenuManager.h"
#include "pqPythonManager.h"
#include "pqServerManagerModel.h"

#include "vtkAvianLidarMaterial.h"
#include "vtkDataObject.h"
#include "vtkPVDataInformation.h"
#include "vtkPVXMLElement.h"
#include "vtkSMInputProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"

#include <QAction>
#include <QCoreApplication>
#include <QDebug>
#include <QFile>
#include <QFileInfo>
#include <QHelpEngine>
#include <QIcon>
#include <QJsonArray>
#include <QJsonDocument>
#include <QList>
#include <QMainWindow>
#include <QMap>
#include <QMenu>
#include <QResource>
#include <QTimer>
#include <QToolBar>
#include <QVariant>
#include <QVector>

#include <dlfcn.h>

#include <string>

namespace
{
constexpr char ScanFilter[] = "AvianLidarEchoFilter";
constexpr char MaterialFilter[] = "AvianLidarMaterial";
constexpr char MacrosMenu[] = "menu_Macros";
constexpr char WizardMacro[] = "avian_lidar_wizard";

/// Macro that colours the outputs of a proxy, when they are first applied, by an array.
struct Colouring
{
  const char* proxy;
  const char* array;
  const char* macro;
};

constexpr Colouring Colourings[] = {
  { ScanFilter, "energy", "avian_lidar_energy_colours" },
  { "AvianLidarRangeImage", "energy", "avian_lidar_energy_colours" },
  { "AvianLidarSequenceReader", "semantic_label", "avian_lidar_class_colours" },
  { "AvianLidarTracks", "species_id", "avian_lidar_species_colours" },
};

//------------------------------------------------------------------------------
// Full path of a macro, in a folder beside the plugin's library.
QString PathOf(const QString& macro)
{
  Dl_info plugin;
  const bool found = dladdr(reinterpret_cast<void*>(&PathOf), &plugin) && plugin.dli_fname;
  const QString library = found ? QString::fromLocal8Bit(plugin.dli_fname) : QString();
  return QFileInfo(library).absolutePath() + "/Macros/" + macro + ".py";
}

//------------------------------------------------------------------------------
// Runs a macro as executeScriptAndRender() does. In ParaView 5.13 that function would make reading
// the file a step of Undo.
// @param answers a dictionary of Python for the macro, or an empty text
void Run(const QString& path, const QString& answers = QString())
{
  pqPythonManager* python = pqPVApplicationCore::instance()->pythonManager();
  QFile file(path);
  if (!file.open(QIODevice::ReadOnly))
  {
    qCritical() << "Cannot read the macro" << path;
  }
  else if (python)
  {
    QByteArray name = path.toUtf8();
    name.replace('\\', "\\\\").replace('\'', "\\'");
    QVector<QByteArray> before = { "__file__ = '" + name + "'" };
    QVector<QByteArray> after = { "del __file__" };
    if (!answers.isEmpty())
    {
      before.append("avian_lidar_answers = " + answers.toUtf8());
      after.append("del avian_lidar_answers");
    }
    python->executeCode(file.readAll(), before, after);
    pqPVApplicationCore::instance()->render();
  }
}

//------------------------------------------------------------------------------
vtkSMProxy* PrototypeOf(pqProxyGroupMenuManager* manager, QAction* action)
{
#if __has_include("pqProxyAction.h")
  (void)manager;
  return pqProxyAction::GetProxyPrototype(action);
#else
  return manager->getPrototype(action);
#endif
}

//------------------------------------------------------------------------------
// Names an action after every change, because ParaView sets the proxy's label again.
void Name(QAction* action, const QString& text)
{
  if (action->property("AvianLidar").isNull())
  {
    action->setProperty("AvianLidar", true);
    QObject::connect(action, &QAction::changed, action, [action, text] { action->setText(text); });
    action->setText(text);
  }
}

//------------------------------------------------------------------------------
// Whether an output of a source has the array at its points or cells.
bool HasArray(pqPipelineSource* source, const QString& array)
{
  const QByteArray name = array.toUtf8();
  for (pqOutputPort* port : source->getOutputPorts())
  {
    vtkPVDataInformation* data = port->getDataInformation();
    if (data->GetArrayInformation(name, vtkDataObject::POINT) ||
      data->GetArrayInformation(name, vtkDataObject::CELL))
    {
      return true;
    }
  }
  return false;
}

//------------------------------------------------------------------------------
// Shows surfaces of one material in its preview colour, unless an array colours the surfaces.
void ShowMaterial(pqPipelineSource* source)
{
  vtkSMProxy* proxy = source->getProxy();
  const std::string pattern = vtkSMPropertyHelper(proxy, "BlockNamePattern").GetAsString();
  double colour[3];
  if ((pattern != "*" && !pattern.empty()) ||
    !vtkAvianLidarMaterial::GetMaterialColor(
      vtkSMPropertyHelper(proxy, "Material").GetAsInt(), colour))
  {
    return;
  }
  for (pqDataRepresentation* display : source->getOutputPort(0)->getRepresentations(nullptr))
  {
    vtkSMPropertyHelper(display->getProxy(), "DiffuseColor", true).Set(colour, 3);
    vtkSMPropertyHelper(display->getProxy(), "AmbientColor", true).Set(colour, 3);
    display->getProxy()->UpdateVTKObjects();
    display->renderViewEventually();
  }
}

//------------------------------------------------------------------------------
// Gives a real lidar the same name in the pipeline as in the menu, with a number if the name is
// taken.
void NameSensor(pqPipelineSource* source)
{
  vtkPVXMLElement* hints = source->getProxy()->GetHints();
  auto* hint = hints ? hints->FindNestedElementByName("AvianLidarMenu") : nullptr;
  if (!hint || !hint->GetAttribute("pipeline"))
  {
    return;
  }
  const QString wanted = hint->GetAttributeOrEmpty("text");
  QString name = wanted;
  const auto* model = pqApplicationCore::instance()->getServerManagerModel();
  for (int i = 2; model->findItem<pqPipelineSource*>(name); ++i)
  {
    name = QString("%1 (%2)").arg(wanted).arg(i);
  }
  source->rename(name);
}

//------------------------------------------------------------------------------
void AddHelp()
{
  pqApplicationCore* core = pqApplicationCore::instance();
#if QT_VERSION >= QT_VERSION_CHECK(6, 0, 0)
  // Otherwise Qt 6 does not add pages.
  core->helpEngine()->setReadOnly(false);
  core->helpEngine()->setupData();
#endif
  core->registerDocumentation(":/AvianLidar/Help/AvianLidarPlugin.qch");
}

//------------------------------------------------------------------------------
class Toolbar : public QToolBar
{
public:
  explicit Toolbar(QMainWindow* window);

private:
  void AddMacros(QMenu* menu);
  void AddFilters(pqProxyGroupMenuManager* manager);
  void EnableActions();
  void EnableFilter(pqOutputPort* port);
  static void Colour(pqProxy* applied);

  pqProxyGroupMenuManager* Filters = nullptr;
  QAction* Filter = nullptr;
  QMap<QAction*, QString> Colours; // actions that need an array
};

//------------------------------------------------------------------------------
Toolbar::Toolbar(QMainWindow* window)
  : QToolBar("Avian Lidar", window)
{
  this->setObjectName("AvianLidarToolbar");
  this->AddMacros(window->findChild<QMenu*>(MacrosMenu));
  for (auto* manager : window->findChildren<pqProxyGroupMenuManager*>())
  {
    connect(manager, &pqProxyGroupMenuManager::menuPopulated, this,
      [this, manager] { this->AddFilters(manager); });
    this->AddFilters(manager);
  }
  connect(pqApplicationCore::instance()->getObjectBuilder(), &pqObjectBuilder::sourceCreated, this,
    NameSensor);
  auto& active = pqActiveObjects::instance();
  connect(&active, &pqActiveObjects::portChanged, this, [this] { this->EnableActions(); });
  connect(&active, &pqActiveObjects::dataUpdated, this, [this] { this->EnableActions(); });
  auto* panel = window->findChild<pqPropertiesPanel*>();
  const auto applied = QOverload<pqProxy*>::of(&pqPropertiesPanel::applied);
  connect(panel, applied, this, &Toolbar::Colour, Qt::QueuedConnection);
  // The output changes before the source counts as applied.
  connect(
    panel, applied, this, [this] { this->EnableActions(); }, Qt::QueuedConnection);
}

//------------------------------------------------------------------------------
void Toolbar::AddMacros(QMenu* menu)
{
  QList<QAction*> all;
  const QResource macros(":/AvianLidar/macros.json");
  for (const QJsonValue& macro : QJsonDocument::fromJson(macros.uncompressedData()).array())
  {
    const QString name = macro["name"].toString();
    const QString text = "Avian Lidar: " + macro["text"].toString();
    const QString tip = macro["tip"].toString();
    const QIcon icon(QString(":/AvianLidar/%1.svg").arg(macro["icon"].toString()));
    auto* action = new QAction(icon, text, this);
    action->setObjectName(name);
    action->setToolTip(QString("<b>%1</b><br>%2").arg(text, tip));
    action->setStatusTip(tip);
    const QString path = PathOf(name);
    const bool asks = name == WizardMacro;
    connect(action, &QAction::triggered, this,
      [path, text, asks]
      {
        const QString answers =
          asks ? AvianLidarAskForScan(pqCoreUtilities::mainWidget()) : QString();
        if (!asks || !answers.isEmpty())
        {
          AvianLidarDoToUndo(text, [path, answers] { Run(path, answers); });
        }
      });
    if (macro["button"].toBool(true))
    {
      this->addAction(action);
    }
    menu->addAction(action);
    all.append(action);
    const QString array = macro["array"].toString();
    if (!array.isEmpty())
    {
      this->Colours.insert(action, array);
    }
  }
#if !__has_include("pqProxyAction.h")
  // The quick launch of ParaView 5.13 ends the program at an action that makes no proxy.
  auto* known = new QMenu(this); // the toolbar itself would add an entry that hides it
  known->addActions(all);
  pqPVApplicationCore::instance()->registerForQuicklaunch(known);
#endif
}

//------------------------------------------------------------------------------
void Toolbar::AddFilters(pqProxyGroupMenuManager* manager)
{
  for (QAction* action : manager->actions())
  {
    if (!action->objectName().startsWith("AvianLidar"))
    {
      continue;
    }
    vtkSMProxy* prototype = PrototypeOf(manager, action);
    vtkPVXMLElement* hints = prototype ? prototype->GetHints() : nullptr;
    if (auto* hint = hints ? hints->FindNestedElementByName("AvianLidarMenu") : nullptr)
    {
      Name(action, hint->GetAttributeOrEmpty("text"));
    }
    // Other menus have actions of their own.
    if (action->objectName() == ScanFilter && manager->menu()->objectName() == "menuFilters" &&
      !this->Filter)
    {
      this->Filters = manager;
      this->Filter = action;
      this->addAction(action); // after the buttons that need no selection
    }
  }
  this->EnableActions();
}

//------------------------------------------------------------------------------
// Enables the actions that fit the active output. Without a port there may be no session.
void Toolbar::EnableActions()
{
  pqOutputPort* port = pqActiveObjects::instance().activePort();
  if (port && port->getSource()->modifiedState() == pqProxy::UNINITIALIZED)
  {
    port = nullptr;
  }
  for (auto colour = this->Colours.begin(); colour != this->Colours.end(); ++colour)
  {
    colour.key()->setEnabled(port && HasArray(port->getSource(), colour.value()));
  }
  if (this->Filter)
  {
    this->Filter->setEnabled(false);
    if (port)
    {
      this->EnableFilter(port);
    }
  }
}

//------------------------------------------------------------------------------
// Enables the filter if the output fits. ParaView enables filters of its own toolbars, and filters
// of other toolbars only when a menu opens.
void Toolbar::EnableFilter(pqOutputPort* port)
{
  vtkSMProxy* prototype = PrototypeOf(this->Filters, this->Filter);
  if (auto* input =
        prototype ? vtkSMInputProperty::SafeDownCast(prototype->GetProperty("Beams")) : nullptr)
  {
    input->RemoveAllUncheckedProxies();
    input->AddUncheckedInputConnection(port->getSource()->getProxy(), port->getPortNumber());
    this->Filter->setEnabled(input->IsInDomains());
    input->RemoveAllUncheckedProxies();
  }
}

//------------------------------------------------------------------------------
void Toolbar::Colour(pqProxy* applied)
{
  auto* source = qobject_cast<pqPipelineSource*>(applied);
  const QString name = source ? source->getProxy()->GetXMLName() : "";
  if (name == MaterialFilter)
  {
    ShowMaterial(source);
  }
  for (const Colouring& colouring : Colourings)
  {
    if (name == colouring.proxy && source->property("AvianLidar").isNull())
    {
      source->updatePipeline(); // because ParaView does not update an image that is not shown
      if (HasArray(source, colouring.array) && pqActiveObjects::instance().activeSource() == source)
      {
        source->setProperty("AvianLidar", true);
        Run(PathOf(colouring.macro));
      }
    }
  }
}
}

//------------------------------------------------------------------------------
void AvianLidarAddToWindow()
{
  auto* window = pqApplicationCore::instance()
    ? qobject_cast<QMainWindow*>(pqCoreUtilities::mainWidget())
    : nullptr;
  if (window && window->findChild<QMenu*>(MacrosMenu) && window->findChild<pqPropertiesPanel*>())
  {
    auto* toolbar = new Toolbar(window);
    window->addToolBar(toolbar);
    toolbar->show(); // also in a window that already exists
    AddHelp();
    AvianLidarAddAdvise();
    if (auto* saving = window->findChild<QAction*>("actionFileSaveData"))
    {
      AvianLidarGuardSaving(saving);
    }
  }
  else if (QCoreApplication* application = QCoreApplication::instance())
  {
    // With Auto Load the plugin is loaded before the window and ParaView's application exist. The
    // delay is necessary: Qt handles posted events before it continues, and without a delay it
    // would never continue.
    QTimer::singleShot(50, application, AvianLidarAddToWindow);
  }
}
