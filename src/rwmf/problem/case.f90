!> Validated description of one scene: the contents of a namelist file with all defaults filled in.
!>
!> An unallocated component means that the group or key is absent from the case; that effect is not
!> simulated.
module rwmf_problem_case
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use rwmf_core_kinds, only: wp
   use rwmf_problem_group_values, only: group_values_t
   use rwmf_problem_quantity_table, only: key_length
   use rwmf_problem_record, only: record_source_t, record_t
   use rwmf_problem_shear_frame, only: shear_frame_t
   implicit none
   private

   public :: case_t, wall_t, frame_t, link_t, devices_t, yielding_t, cable_t
   public :: spring_law_t
   public :: impact_t, motion_spec_t, inerter_t, vertical_t, base_t
   public :: initial_t, model_choice_t, solver_t, output_t, spectrum_spec_t, structure_t
   public :: keep_numbers, has_numbers, numbers_of, has_floors, has_all_modes
   public :: copy_without_frame, list_links, upward_ratio, seeks

   !> Rocking wall, `&wall`.
   type :: wall_t
      real(wp) :: h
      !! half height [m]
      real(wp) :: b
      !! half width [m]
      real(wp), allocatable :: m_w
      !! mass [kg]; if given, forces are also reported in N
      character(7) :: base = 'rocking'
      !! 'rocking' or 'pinned'
      logical :: shear_key = .false.
      !! a shear key prevents sliding of the base instead of friction
      integer :: walls = 1
      !! number of equal walls side by side
   end type wall_t

   !> Link of finite length between wall and frame, `&link`, Eqs (2), (3).
   type :: link_t
      real(wp) :: L
      !! length [m]
   end type link_t

   !> Moment frame, `&frame`: a single mass, or several floors (`&storeys`), which then set period
   !> and mass ratio.
   type :: frame_t
      real(wp), allocatable :: T_s
      !! undamped period [s]; may be absent when `&spectrum` gives the periods
      real(wp), allocatable :: gamma
      !! mass ratio m_s/m_w [-]; absent for the bare frame
      real(wp) :: xi_s
      !! viscous damping ratio [-]
      logical :: is_linked = .true.
      !! its mass moves with the wall; false with link springs between them
      type(shear_frame_t), allocatable :: floors
      !! its floors with their modes; absent for a single mass, as the next two
      character(:), allocatable :: coupling
      !! 'reduced': first mode only; 'every_floor': straight line enforced by the wall; 'full': all
      !! modes, with the roof linked to the wall; 'springs': all modes, with link springs
      real(wp), allocatable :: k_link(:)
      !! (floors) stiffness of the link springs over m_w [1/s2]; only with 'springs'
   end type frame_t

   !> Law of a spring with memory, apart from its strength and its hardening.
   type :: spring_law_t
      character(15) :: name = 'elastic_plastic'
      !! 'elastic_plastic', 'friction', 'flag', 'peak_oriented', 'pinched' or 'bouc_wen'
      real(wp) :: breakaway = 1
      !! of 'friction': static over kinetic friction force [-]
      real(wp) :: flag_height = 1
      !! of 'flag': height of the flag over the yield force [-]
      real(wp) :: cap = huge(1.0_wp)
      !! of 'peak_oriented' and 'pinched', as the next five components: displacement at the capping
      !! point over that at first yield [-]
      real(wp) :: post_cap = huge(1.0_wp)
      !! displacement from the capping point to zero force, over that at first yield [-]
      real(wp) :: residual = 0
      !! residual force over the force at first yield [-]
      real(wp) :: lambda(4) = huge(1.0_wp)
      !! energy capacities over F_y u_y for the deterioration of strength, post-capping strength,
      !! reloading stiffness and unloading stiffness [-]
      real(wp) :: lambda_exponent(4) = 1
      !! exponents of these deterioration rates [-]
      real(wp) :: pinch_force = 1
      !! of 'pinched': force at the pinching point over that on the line without pinching [-]
      real(wp) :: pinch_displacement = 1
      !! of 'pinched': part of the plastic displacement that remains beyond the pinching point [-]
      real(wp) :: exponent = 2
      !! of 'bouc_wen': n [-]
      real(wp) :: beta = 0.5_wp
      !! of 'bouc_wen' [-]
   end type spring_law_t

   !> Devices of one group: `&fuse`, `&damper`, `&nl_damper`, `&coupling`, `&restraint`. Lists have
   !> one number for each device.
   type :: devices_t
      real(wp), allocatable :: offset(:)
      !! places to the right of the wall's axis [m]; absent: the corners of the base
      real(wp), allocatable :: height(:)
      !! heights above the base, of restraints [m]
      real(wp) :: span = 0
      !! clear span of coupling beams [m]
      real(wp), allocatable :: eta_y(:)
      !! yield forces over m_w g [-]; absent: no spring, or a linear one
      real(wp), allocatable :: stroke_y(:)
      !! strokes at first yield [m]
      real(wp), allocatable :: hardening(:)
      !! stiffness after yielding over elastic stiffness [-]
      type(spring_law_t) :: law
      !! law of the springs that yield
      real(wp), allocatable :: k(:)
      !! stiffnesses of linear springs over m_w [1/s2]; absent: none
      real(wp), allocatable :: c(:)
      !! constants of viscous dampers over m_w [1/s]; absent: none
      real(wp), allocatable :: eta_1(:)
      !! forces of nonlinear dampers at 1 m/s over m_w g [-]; absent: none
      real(wp), allocatable :: exponent(:)
      !! of these dampers [-]
   end type devices_t

   !> Inelastic frame, `&yielding`.
   type :: yielding_t
      real(wp), allocatable :: u_y
      !! displacement at first yield [m]; exactly one of this and the next two is given
      real(wp), allocatable :: f_y_over_m_s_g
      !! yield force over the weight of the frame [-]
      real(wp), allocatable :: storey_u_y(:)
      !! of `&storeys`: interstorey displacement at first yield, one for all storeys or one for each
      !! [m]
      real(wp) :: hardening = 0
      !! stiffness after yielding over elastic stiffness [-]
      type(spring_law_t) :: law
      real(wp), allocatable :: ultimate
      !! ductility at collapse of the frame or of a storey [-]; absent: no collapse
   end type yielding_t

   !> Inerters at the corners of the base, `&inerter`.
   type :: inerter_t
      real(wp) :: inertance_over_m_w
      !! inertance over the mass of the wall [-]
   end type inerter_t

   !> Unbonded post-tensioned tendons, `&cable`, Eq. (1). Lists have one number for each tendon.
   type :: cable_t
      real(wp), allocatable :: eta_0(:)
      !! P(0)/(m_w g) [-]
      real(wp), allocatable :: eta_alpha(:)
      !! P(alpha)/(m_w g) of the same tendon on the axis [-]
      character(:), allocatable :: law
      !! 'linear' or 'truss'
      real(wp), allocatable :: offset(:)
      !! places to the right of the wall's axis [m]
      real(wp), allocatable :: height(:)
      !! heights of the upper anchors [m]; absent: the height of the wall
      real(wp), allocatable :: eta_y(:)
      !! P/(m_w g) at yield [-]; absent: elastic
      real(wp), allocatable :: hardening(:)
      !! stiffness after yielding over elastic stiffness [-]
      real(wp), allocatable :: rupture_strain(:)
      !! strain at rupture, including the prestrain [-]; absent: no rupture
      real(wp), allocatable :: length(:)
      !! unbonded lengths [m]; absent: the heights of the upper anchors
      real(wp), allocatable :: area(:)
      !! total areas of the strands [m2]; absent: unknown
   end type cable_t

   !> Strip of springs without tension under the base, `&base`.
   type :: base_t
      real(wp) :: stiffness = 0
      !! per length of the base over m_w [1/(m s2)]
      real(wp) :: modulus = 0
      !! subgrade modulus [N/m3]; 0: unknown
      real(wp) :: xi = 0
      !! damping ratio of the vertical motion in full contact [-]
      real(wp), allocatable :: delay
      !! damping over stiffness [s]; absent: from xi
      real(wp), allocatable :: mu
      !! coefficient of friction [-]; absent: no sliding
      real(wp), allocatable :: d_y
      !! settlement at crushing [m]; absent: elastic
      integer :: strips = 20
      !! number of strips that crush one by one
   end type base_t

   !> Energy loss at the impacts of a rocking wall, `&impact`.
   type :: impact_t
      character(8) :: rule = 'coupled'
      !! 'coupled', 'constant', 'housner', 'table' or 'none'
      real(wp), allocatable :: e
      !! velocity factor of rule 'constant' [-], also when the case gives r = e**2
      logical :: given_as_r = .false.
      !! the case gives r instead of e
      real(wp), allocatable :: table_theta_dot(:)
      !! (n) of rule 'table': angular velocities before impact, increasing [rad/s]
      real(wp), allocatable :: table_e(:)
      !! (n) velocity factors there [-]
   end type impact_t

   !> Ground motion, `&motion`.
   type, extends(record_source_t) :: motion_spec_t
      character(:), allocatable :: kind
      !! 'none', a pulse ('one_sine', 'one_cosine', 'sine', 'type_c', 'ricker',
      !! 'ricker_antisymmetric', 'mavroeidis_papageorgiou') or 'record'
      real(wp), allocatable :: a_max_g
      !! peak acceleration of the pulse over `&model g` [-]
      real(wp), allocatable :: v_p
      !! velocity amplitude of the pulse [m/s], Eqs (16), (17); not for Ricker pulses
      real(wp), allocatable :: omega_p
      !! angular frequency of the pulse [rad/s]
      real(wp), allocatable :: T_p
      !! period of the pulse [s]
      real(wp) :: cycles
      !! number of cycles of kind 'sine' [-], 1 for the other pulses
      integer :: n_pulses
      !! n of kind 'type_c', C_n
      real(wp), allocatable :: gamma_p
      !! gamma of kind 'mavroeidis_papageorgiou', the number of its cycles [-]
      real(wp) :: nu
      !! phase of the pulse of kind 'mavroeidis_papageorgiou' [rad]
      real(wp) :: t_0
      !! start of the pulse [s]
   end type motion_spec_t

   !> Vertical ground motion, `&vertical`, given by a ratio or a record.
   type, extends(record_source_t) :: vertical_t
      real(wp), allocatable :: ratio
      !! ratio of the vertical to the horizontal acceleration [-]
   end type vertical_t

   !> Initial state, `&initial`.
   type :: initial_t
      real(wp) :: theta_over_alpha
      !! rotation over slenderness [-]
      real(wp) :: theta_dot
      !! angular velocity [rad/s]
   end type initial_t

   !> Mathematical model, `&model`.
   type :: model_choice_t
      character(:), allocatable :: formulation
      !! 'published', 'symmetric' or 'exact'
      real(wp) :: g
      !! gravity [m/s2]
      real(wp) :: overturning_angle
      !! rotation at which the wall counts as overturned [rad]
   end type model_choice_t

   !> Time integration, `&solver`.
   type :: solver_t
      character(:), allocatable :: method
      !! name of the integrator
      real(wp) :: rtol
      !! relative tolerance of the integrator [-]
      real(wp), allocatable :: accuracy
      !! required relative error of a peak [-]; rtol is then chosen accordingly
      character(key_length) :: accuracy_of = ''
      !! key of that peak, also used by `verify`; '': u_s_max (without a frame theta_max)
      logical :: verify
      !! estimate the error and the sensitivity by further runs
      real(wp), allocatable :: atol
      !! absolute tolerance on theta [rad] (bare frame: on u [m]); absent: derived from the response
      real(wp), allocatable :: t_end
      !! end of the simulation [s]; absent: last sample of the record
      integer :: max_steps
      !! largest number of internal steps of one simulation
   end type solver_t

   !> Output, `&output`.
   type :: output_t
      real(wp), allocatable :: dt
      !! interval of the history [s]; absent: no history
      logical :: energy
      !! record the energy ledger
      logical :: reactions = .false.
      !! record the reactions of the base: pivot, base shear, drifts
      logical :: demands = .false.
      !! record drifts, accelerations and shears of floors, storeys and wall
      logical :: envelopes = .false.
      !! record forces of wall, links and pivot, velocities of floors, travel of fuses
      real(wp), allocatable :: friction_limit
      !! available coefficient of friction, to be compared with the demand [-]
      logical, allocatable :: conditioning
      !! report the sensitivity of each peak to the motion; absent: single runs do
      character(key_length), allocatable :: limited(:)
      !! (demands) keys of the demands that `&limits` requests; absent without limits
      integer, allocatable :: sought(:)
      !! numbers (`id`) of the requested quantities of an ordinate; absent: all of these outputs
   end type output_t

   !> Loop over frame periods, `&spectrum`.
   type :: spectrum_spec_t
      real(wp), allocatable :: T_s(:)
      !! individual periods [s]; absent: the grid of the next four components
      real(wp), allocatable :: T_s_min
      !! shortest period [s]
      real(wp), allocatable :: T_s_max
      !! longest period [s]
      integer, allocatable :: n
      !! number of periods, both ends included
      character(:), allocatable :: spacing
      !! 'linear' or 'log'
      real(wp), allocatable :: gamma(:)
      !! mass ratios [-]; absent: that of the case
      real(wp), allocatable :: b(:)
      !! half widths of the wall [m]; absent: that of the case
      character(:), allocatable :: quantities(:)
      !! (n) keys of the quantities reported for each ordinate; absent: u_s_max_m
   end type spectrum_spec_t

   !> Parameters of an effect that needs only a few numbers.
   type :: effect_numbers_t
      character(12) :: group = ''
      !! group that gives them
      real(wp), allocatable :: values(:)
      !! values in the order that the effect defines
   end type effect_numbers_t

   !> Simulated structure without its motion: the components that another run of the same scene
   !> copies by one assignment. Unallocated components are effects that the scene does not include.
   type :: structure_t
      type(wall_t), allocatable :: wall
      type(frame_t), allocatable :: frame
      type(link_t), allocatable :: link
      type(devices_t), allocatable :: fuse
      type(devices_t), allocatable :: damper
      type(devices_t), allocatable :: nl_damper
      type(devices_t), allocatable :: coupling
      type(devices_t), allocatable :: restraint
      type(yielding_t), allocatable :: yielding
      type(inerter_t), allocatable :: inerter
      type(cable_t), allocatable :: cable
      type(impact_t) :: impact
      type(base_t), allocatable :: compliant_base
      type(vertical_t), allocatable :: upward
      type(initial_t), allocatable :: initial
      type(model_choice_t) :: model
      real(wp) :: unit_mass = 0
      !! reference mass of all ratios [kg]: mass of the wall; without a wall, mass of the frame. It
      !! is 1 kg for storeys in kg, and 0 if the case gives no mass.
      logical :: follows_size = .false.
      !! the ratios follow from masses and forces, and hence from the size of the wall
      type(effect_numbers_t), allocatable :: numbers(:)
      !! parameters of the effects that have no type for them (`keep_numbers`)
   end type structure_t

   !> One case: structure, motion, time integration and output. The inherited components of
   !> `structure_t` are components of the case (`case%wall`).
   type, extends(structure_t) :: case_t
      character(:), allocatable :: text
      !! namelist text of the case
      type(group_values_t) :: values
      !! values of that text and the defaults; empty for a case that was not read from text
      type(motion_spec_t), allocatable :: motion
      type(solver_t) :: solver
      type(output_t), allocatable :: output
      type(spectrum_spec_t), allocatable :: spectrum
      type(record_t), allocatable :: record
      !! samples of the record given by `&motion file`
      type(record_t), allocatable :: upward_record
      !! samples of the record given by `&vertical file`
   end type case_t

contains

   !> True if the frame of a case has floors, not a single mass.
   pure logical function has_floors(case)
      class(structure_t), intent(in) :: case

      has_floors = allocated(case%frame)
      if (has_floors) has_floors = allocated(case%frame%floors)
   end function has_floors

   !> True if the frame of a case has floors that move independently.
   pure logical function has_all_modes(case)
      class(structure_t), intent(in) :: case

      has_all_modes = has_floors(case)
      if (has_all_modes) has_all_modes = any(case%frame%coupling == [character(7) :: 'full', &
         'springs'])
   end function has_all_modes

   !> Keep the numbers of the group of an effect.
   pure subroutine keep_numbers(case, group, values)
      class(structure_t), intent(inout) :: case
      character(*), intent(in) :: group
      !! name of the group, without &
      real(wp), intent(in) :: values(:)
      !! values in the order that the effect defines, each in the unit of its key
      type(effect_numbers_t), allocatable :: all_numbers(:)
      integer :: n

      n = 0
      if (allocated(case%numbers)) n = size(case%numbers)
      allocate (all_numbers(n + 1))
      if (n > 0) all_numbers(:n) = case%numbers
      all_numbers(n + 1)%group = group
      all_numbers(n + 1)%values = values
      call move_alloc(all_numbers, case%numbers)
   end subroutine keep_numbers

   !> True if the case has numbers of a group.
   pure logical function has_numbers(case, group)
      class(structure_t), intent(in) :: case
      character(*), intent(in) :: group
      !! name of the group, without &

      has_numbers = .false.
      if (allocated(case%numbers)) has_numbers = any(case%numbers%group == group)
   end function has_numbers

   !> Copy a case without its frame and its records, for a host that owns the frame.
   subroutine copy_without_frame(case, wall_alone)
      type(case_t), intent(in) :: case
      type(case_t), intent(out) :: wall_alone
      integer :: i

      wall_alone%structure_t = case%structure_t
      if (allocated(wall_alone%frame)) deallocate (wall_alone%frame)
      if (allocated(wall_alone%yielding)) deallocate (wall_alone%yielding)
      if (.not. allocated(case%numbers)) return
      deallocate (wall_alone%numbers)
      do i = 1, size(case%numbers)
         if (case%numbers(i)%group /= 'p_delta') call keep_numbers(wall_alone, &
            case%numbers(i)%group, case%numbers(i)%values)
      end do
   end subroutine copy_without_frame

   !> List the links between wall and frame: one at the roof, or one for each floor.
   pure subroutine list_links(case, share, stiffness, mass)
      type(case_t), intent(in) :: case
      real(wp), allocatable, intent(out) :: share(:)
      !! (links) height over that of the roof [-]
      real(wp), allocatable, intent(out) :: stiffness(:)
      !! (floors) stiffness of link springs over m_w [1/s2]; not allocated for rigid links
      real(wp), allocatable, intent(out) :: mass(:)
      !! (links) mass of the frame that moves with a rigid link, over m_w [-]
      integer :: i

      share = [1.0_wp]
      if (has_floors(case)) then
         if (any(case%frame%coupling == [character(11) :: 'every_floor', 'springs'])) then
            associate (height => case%frame%floors%height)
               share = [(sum(height(:i)), i=1, size(height))]/sum(height)
            end associate
         end if
         if (allocated(case%frame%k_link)) stiffness = case%frame%k_link
      end if
      allocate (mass(size(share)), source=0.0_wp)
      if (.not. allocated(case%frame)) return
      if (.not. (case%frame%is_linked .and. allocated(case%frame%gamma))) return
      mass(:) = case%frame%gamma
      if (size(share) == 1) return
      associate (frame => case%frame%floors)
         mass(:) = case%frame%gamma*frame%shape(size(frame%m), 1)**2*frame%m
      end associate
   end subroutine list_links

   !> Ratio of the vertical to the horizontal ground acceleration; NaN for a vertical record.
   pure real(wp) function upward_ratio(case)
      type(case_t), intent(in) :: case

      upward_ratio = 0
      if (.not. allocated(case%upward)) return
      upward_ratio = ieee_value(upward_ratio, ieee_quiet_nan)
      if (allocated(case%upward%ratio)) upward_ratio = case%upward%ratio
   end function upward_ratio

   !> Numbers of a group; the case must have them.
   pure function numbers_of(case, group) result(values)
      class(structure_t), intent(in) :: case
      character(*), intent(in) :: group
      !! name of the group, without &
      real(wp), allocatable :: values(:)
      integer :: i

      do i = 1, size(case%numbers)
         if (case%numbers(i)%group == group) values = case%numbers(i)%values
      end do
   end function numbers_of

   !> Return whether a request includes at least one of some quantities.
   pure logical function seeks(output, numbers)
      type(output_t), intent(in) :: output
      integer, intent(in) :: numbers(:)
      !! (quantities) their `id`
      integer :: i

      seeks = .not. allocated(output%sought)
      if (.not. seeks) seeks = any([(any(output%sought == numbers(i)), i=1, size(numbers))])
   end function seeks

end module rwmf_problem_case
