// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarAdvise.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqInterfaceTracker.h"
#include "pqPropertyWidget.h"
#include "pqPropertyWidgetInterface.h"
#include "pqServer.h"
#include "pqTimeKeeper.h"

#include "vtkSMDoubleVectorProperty.h"
#include "vtkSMInputProperty.h"
#include "vtkSMIntVectorProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMPropertyIterator.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMUncheckedPropertyHelper.h"
#include "vtkSmartPointer.h"

#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QString>

#include <cstring>

namespace
{
constexpr char Widget[] = "avian_lidar_advise"; // name in the property's XML

// Properties of the echo filter that advice sets. The advisor's names have the prefix Advised.
constexpr const char* Advised[] = { "BeamSamples", "RaysPerBeam", "Sampling", "NumberOfReflections",
  "NumberOfConnections" };

// Number of lines of the advice that fit into the panel. The tool tip has all lines.
constexpr int ShownLines = 4;

//------------------------------------------------------------------------------
class AdviseWidget : public pqPropertyWidget
{
public:
  AdviseWidget(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent);

private:
  QDoubleSpinBox* Add(
    QFormLayout* layout, const char* name, const char* text, const char* unit, double value);
  void Ask(vtkSMSourceProxy* advisor) const;
  void Advise();
  void Take(vtkSMSourceProxy* advisor);

  QDoubleSpinBox* Energy;
  QDoubleSpinBox* Range;
  QDoubleSpinBox* Missed;
  QLabel* Answer;
};

//------------------------------------------------------------------------------
// Registered here, not by UI_INTERFACES of paraview_add_plugin(): UI_INTERFACES links ParaView's
// CMake targets, which need the packages of all rendering libraries.
class Maker
  : public QObject
  , public pqPropertyWidgetInterface
{
public:
  using QObject::QObject;

  pqPropertyWidget* createWidgetForProperty(
    vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent) override
  {
    const char* wanted = property->GetPanelWidget();
    return wanted && std::strcmp(wanted, Widget) == 0 ? new AdviseWidget(proxy, property, parent)
                                                      : nullptr;
  }

  // The function that Qt's moc would write. ParaView finds the interface of an object by its name.
  void* qt_metacast(const char* name) override
  {
    return std::strcmp(name, qobject_interface_iid<pqPropertyWidgetInterface*>()) == 0
      ? static_cast<pqPropertyWidgetInterface*>(this)
      : QObject::qt_metacast(name);
  }
};

//------------------------------------------------------------------------------
AdviseWidget::AdviseWidget(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent)
  : pqPropertyWidget(proxy, parent)
{
  this->setShowLabel(false);
  auto* layout = new QFormLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  this->Energy = this->Add(layout, "AdviseEnergy", "Energy Error", " % rms", 2.0);
  this->Range = this->Add(layout, "AdviseRange", "Range Error", " m rms", 0.05);
  this->Missed = this->Add(layout, "AdviseMissed", "Wrong Echoes", " %", 1.0);
  auto* button = new QPushButton("Advise", this);
  button->setObjectName("Advise");
  button->setToolTip(pqPropertyWidget::getTooltip(property));
  layout->addRow(button);
  this->Answer = new QLabel(this);
  this->Answer->setObjectName("AdviseAnswer");
  this->Answer->setWordWrap(true);
  this->Answer->setTextInteractionFlags(Qt::TextSelectableByMouse);
  this->Answer->hide();
  layout->addRow(this->Answer);
  QObject::connect(button, &QPushButton::clicked, this, [this] { this->Advise(); });
}

//------------------------------------------------------------------------------
QDoubleSpinBox* AdviseWidget::Add(
  QFormLayout* layout, const char* name, const char* text, const char* unit, double value)
{
  auto* box = new QDoubleSpinBox(this);
  box->setObjectName(name);
  box->setDecimals(3);
  box->setRange(0.001, 1000.0);
  box->setSingleStep(value / 2.0);
  box->setSuffix(unit);
  box->setValue(value);
  box->setToolTip("Largest error of the advised settings, compared with a reference");
  layout->addRow(text, box);
  return box;
}

//------------------------------------------------------------------------------
// Gives the advisor the values that the panel shows, also values that are not applied.
void AdviseWidget::Ask(vtkSMSourceProxy* advisor) const
{
  vtkSmartPointer<vtkSMPropertyIterator> each;
  each.TakeReference(advisor->NewPropertyIterator());
  for (each->Begin(); !each->IsAtEnd(); each->Next())
  {
    vtkSMProperty* to = each->GetProperty();
    vtkSMProperty* from = this->proxy()->GetProperty(each->GetKey());
    if (!from || to->GetInformationOnly())
    {
      continue;
    }
    if (vtkSMInputProperty::SafeDownCast(to))
    {
      to->Copy(from);
    }
    else if (vtkSMIntVectorProperty::SafeDownCast(to) ||
      vtkSMDoubleVectorProperty::SafeDownCast(to))
    {
      vtkSMPropertyHelper(to).Set(vtkSMUncheckedPropertyHelper(from).GetAsDouble());
    }
  }
  vtkSMPropertyHelper(advisor, "EnergyError").Set(0.01 * this->Energy->value());
  vtkSMPropertyHelper(advisor, "RangeError").Set(this->Range->value());
  vtkSMPropertyHelper(advisor, "MissedShare").Set(0.01 * this->Missed->value());
  advisor->UpdateVTKObjects();
}

//------------------------------------------------------------------------------
void AdviseWidget::Advise()
{
  vtkSmartPointer<vtkSMProxy> made;
  made.TakeReference(
    this->proxy()->GetSessionProxyManager()->NewProxy("internal_avian_lidar", "AvianLidarAdvisor"));
  auto* advisor = vtkSMSourceProxy::SafeDownCast(made);
  if (!advisor)
  {
    return; // ParaView has reported the reason
  }
  this->Ask(advisor);
  pqServer* server = pqActiveObjects::instance().activeServer();
  advisor->UpdatePipeline(server ? server->getTimeKeeper()->getTime() : 0.0);
  advisor->UpdatePropertyInformation();
  this->Take(advisor);
}

//------------------------------------------------------------------------------
void AdviseWidget::Take(vtkSMSourceProxy* advisor)
{
  const QString advice = vtkSMPropertyHelper(advisor, "Advice").GetAsString();
  const QStringList lines = advice.split('\n');
  this->Answer->setText(advice.isEmpty() ? QString("No advice: nothing was measured")
                                         : QStringList(lines.mid(0, ShownLines)).join("\n\n"));
  this->Answer->setToolTip(advice);
  this->Answer->show();
  if (vtkSMPropertyHelper(advisor, "AdvisedRaysPerBeam").GetAsInt() < 1)
  {
    return;
  }
  vtkSMUncheckedPropertyHelper(this->proxy(), "Preset").Set(0); // Custom uses the values below
  for (const char* name : Advised)
  {
    const QByteArray of = QByteArray("Advised") + name;
    vtkSMUncheckedPropertyHelper(this->proxy(), name)
      .Set(vtkSMPropertyHelper(advisor, of.constData()).GetAsInt());
  }
  Q_EMIT this->changeAvailable();
}
}

//------------------------------------------------------------------------------
void AvianLidarAddAdvise()
{
  pqApplicationCore* core = pqApplicationCore::instance();
  core->interfaceTracker()->addInterface(new Maker(core));
}
